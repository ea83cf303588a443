// Shading models. Colours are sRGB-encoded and mixed as they are, as the models' authors did.

float highlight(vec3 normal, vec3 direction, float exponent) {
    return pow(max(dot(reflect(direction, normal), frame.light.xyz), 0.0), exponent);
}

// Gooch et al. 1998, section 4.1: from cool away from the light to warm towards it. Their blue and
// yellow (b = y = 0.4, alpha = 0.2, beta = 0.6) are made for white objects; these are milder, so
// that a surface keeps its own colour. Edges darken a little, as their section 3 has outlines, and
// a soft highlight gives gloss.
vec3 gooch(vec3 color, vec3 normal, vec3 direction) {
    const vec3 cool = vec3(0.05, 0.09, 0.22) + 0.28 * color;
    const vec3 warm = vec3(0.14, 0.11, 0.03) + 0.84 * color;
    const float warmth = smoothstep(0.0, 1.0, 0.5 + 0.5 * dot(normal, frame.light.xyz));
    const float facing = clamp(-dot(normal, direction), 0.0, 1.0);
    return mix(cool, warm, warmth) * (0.55 + 0.45 * sqrt(facing)) +
           0.16 * highlight(normal, direction, 24.0);
}

vec3 phong(vec3 color, vec3 normal, vec3 direction) {
    const float diffuse = max(dot(normal, frame.light.xyz), 0.0);
    const float facing = max(-dot(normal, direction), 0.0);  // a head light fills the shadows
    return color * (0.12 + 0.68 * diffuse + 0.2 * facing) +
           0.3 * highlight(normal, direction, 48.0);
}
