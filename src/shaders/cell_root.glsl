// The trilinear field along a straight line through one cell is a cubic (Marmitt et al. 2004, "Fast
// and accurate ray-voxel intersection techniques for iso-surface ray tracing"): its crossings of
// the isovalue.

struct CellLine {
    vec4 cubic;   // coefficients of 1, s, s^2, s^3 of (value - isovalue), s in [0, 1]
    vec2 splits;  // where the cubic turns, ascending; outside (0, 1) when it does not
};

float cubic_at(vec4 c, float s) { return c.x + s * (c.y + s * (c.z + s * c.w)); }

float slope_at(vec4 c, float s) { return c.y + s * (2.0 * c.z + s * 3.0 * c.w); }

// `from` and `to` are within the cell, 0 to 1 along each axis (or a rounding error beyond).
CellLine cell_line(float corners[8], vec3 from, vec3 to, float iso) {
    const float a = trilinear(corners, from) - iso;
    const float b = trilinear(corners, mix(from, to, 1.0 / 3.0)) - iso;
    const float c = trilinear(corners, mix(from, to, 2.0 / 3.0)) - iso;
    const float d = trilinear(corners, to) - iso;
    CellLine line;
    line.cubic = vec4(a, -5.5 * a + 9.0 * b - 4.5 * c + d, 9.0 * a - 22.5 * b + 18.0 * c - 4.5 * d,
                      -4.5 * a + 13.5 * b - 13.5 * c + 4.5 * d);
    // Roots of the derivative, by the form of the quadratic formula that does not cancel.
    const float p = line.cubic.z, q = 3.0 * line.cubic.w, discriminant = p * p - q * line.cubic.y;
    line.splits = vec2(-1.0);
    if (discriminant > 0.0) {
        const float w = -(p + (p < 0.0 ? -1.0 : 1.0) * sqrt(discriminant));
        const float first = q != 0.0 ? w / q : -1.0, second = w != 0.0 ? line.cubic.y / w : -1.0;
        line.splits = vec2(min(first, second), max(first, second));
    }
    return line;
}

// The crossing in [a, b], where the cubic is monotonic and changes sign: Newton's method from the
// secant's point on, within the bracket, which is halved where that leaves it.
float solve_between(vec4 cubic, float a, float b) {
    const float fa = cubic_at(cubic, a), fb = cubic_at(cubic, b);
    float s = fa == fb ? 0.5 * (a + b) : clamp((a * fb - b * fa) / (fb - fa), a, b);
    for (int i = 0; i < 8; ++i) {
        const float f = cubic_at(cubic, s), next = s - f / slope_at(cubic, s);
        if ((f >= 0.0) == (fb >= 0.0)) b = s;
        else a = s;
        const float last = s;
        s = next >= a && next <= b ? next : 0.5 * (a + b);
        if (abs(s - last) < 1e-6) break;
    }
    return s;
}

// The first s at which the line is no longer on the side `inside`; false if it stays there.
bool first_crossing(CellLine line, bool inside, out float s) {
    float a = 0.0;
    for (int i = 0; i < 3; ++i) {
        const float b = i == 2 ? 1.0 : line.splits[i];
        if (i < 2 && !(b > a && b < 1.0)) continue;
        if ((cubic_at(line.cubic, b) >= 0.0) != inside) {
            const bool at_start = (cubic_at(line.cubic, a) >= 0.0) != inside;
            s = at_start ? a : solve_between(line.cubic, a, b);
            return true;
        }
        a = b;
    }
    return false;
}

// The crossing nearest to s = `near`; false if there is none.
bool nearest_crossing(CellLine line, float near, out float s) {
    bool found = false;
    float a = 0.0;
    for (int i = 0; i < 3; ++i) {
        const float b = i == 2 ? 1.0 : line.splits[i];
        if (i < 2 && !(b > a && b < 1.0)) continue;
        if ((cubic_at(line.cubic, a) >= 0.0) != (cubic_at(line.cubic, b) >= 0.0)) {
            const float root = solve_between(line.cubic, a, b);
            if (!found || abs(root - near) < abs(s - near)) s = root;
            found = true;
        }
        a = b;
    }
    return found;
}
