// Half of a block, 8x8x4 cells (the paper's block, section 3.2), as rows of bits. Its 9x9x5 corners
// are 45 corner rows of 9 along x; its cells are 32 cell rows of 8.
#include "shaders/cases.glsl"

const uint CORNER_ROWS = 45, CELL_ROWS = 32, SIGN_WORDS = 15;

// From the task shader to its mesh shaders: 80 bytes, where the paper's interface block takes 324.
struct Payload {
    uint first_cell[3];      // the half block's lowest corner
    uint row_starts;         // bit r: a mesh workgroup begins at cell row r
    uint row_splits;         // bit r: row r alone has two workgroups, for x < 4 and x >= 4
    uint signs[SIGN_WORDS];  // three corner rows of 9 bits a word
};
