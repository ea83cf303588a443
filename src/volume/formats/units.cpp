// SPDX-License-Identifier: MIT
// Names of units: whatever a header says, and one symbol for each length that has several
// spellings.
#include "volume/formats/units.h"

#include "volume/text.h"
#include "volume/utf8.h"

namespace isorast {
namespace {

constexpr size_t LONGEST = 16;

// In lower case and without the s of a plural.
constexpr std::pair<std::string_view, std::string_view> LENGTHS[] = {
    {"meter", "m"},       {"metre", "m"},       {"centimeter", "cm"},
    {"centimetre", "cm"}, {"millimeter", "mm"}, {"millimetre", "mm"},
    {"micrometer", "um"}, {"micrometre", "um"}, {"micron", "um"},
    {"nanometer", "nm"},  {"nanometre", "nm"},  {"\u00b5m", "um"},  // the micro sign
    {"\u03bcm", "um"},                                              // the Greek letter
    {"\\mu m", "um"},
};

bool is_control(char c) {
    return (c >= 0 && c < ' ') || c == '\x7f';
}

}  // namespace

std::string unit_name(std::string_view text) {
    std::string name = as_utf8(text);
    for (char& c : name)
        if (is_control(c)) c = '?';
    if (name.size() <= LONGEST) return name;
    // Cut before a character, not inside of one.
    size_t end = LONGEST;
    while (end > 0 && (name[end] & 0xc0) == 0x80)
        --end;
    return name.substr(0, end);
}

std::string length_unit(std::string_view text) {
    std::string word = lowercase(as_utf8(text));
    if (word.ends_with('s')) word.pop_back();
    for (const auto& [spelling, symbol] : LENGTHS)
        if (word == spelling) return std::string(symbol);
    return unit_name(text);
}

}  // namespace isorast
