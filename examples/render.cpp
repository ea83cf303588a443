// SPDX-License-Identifier: MIT
// The README's lines: from a volume file to a picture. isorast_example FILE ISOVALUE PICTURE.png
#include <isorast/isorast.h>

#include <cstdio>
#include <cstdlib>

static void render(const char* file, double isovalue, const char* picture) {
    isorast::Gpu gpu;  // picks a device, or throws why none fits
    isorast::Volume head = isorast::load_volume(file);
    isorast::Renderer renderer(gpu, head, {.technique = "direct"});
    isorast::Image image = renderer.render({
        .isovalues = {isovalue},
        .camera = isorast::orbit(head, /* azimuth_degrees= */ 30, /* elevation_degrees= */ 20),
        .size = {1920, 1080},
    });
    isorast::write_png(picture, image);
}

int main(int argc, char** argv) {
    if (argc != 4) {
        std::fputs("usage: isorast_example FILE ISOVALUE PICTURE.png\n", stderr);
        return 2;
    }
    try {
        render(argv[1], std::atof(argv[2]), argv[3]);
    } catch (const isorast::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
