// SPDX-License-Identifier: MIT
// Wavefront OBJ: text, an object for each mesh, vertices numbered through the whole file from 1.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "mesh/formats.h"

namespace isorast {

namespace {

// Collects lines, and writes them a mebibyte at a time.
class Lines {
public:
    explicit Lines(WholeFile& file) : file_(file) {}
    ~Lines() = default;
    template <class... Values>
    void add(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
        if (text_.size() > 1u << 20) flush();
    }
    void flush() {
        file_.write(text_);
        text_.clear();
    }

private:
    WholeFile& file_;
    std::string text_;
};

void write_positions(Lines& lines, const Mesh& mesh) {
    // As few digits as tell the numbers apart.
    const bool as_float = floats_suffice(mesh);
    for (const auto& p : mesh.positions) {
        const auto f = as_floats(p);
        if (as_float)
            lines.add("v {} {} {}\n", f[0], f[1], f[2]);
        else
            lines.add("v {} {} {}\n", p[0], p[1], p[2]);
    }
}

}  // namespace

void write_obj(const std::string& path, const std::vector<Mesh>& meshes) {
    WholeFile file(path);
    Lines lines(file);
    uint64_t first = 1;
    for (const Mesh& mesh : meshes) {
        std::string name = mesh.name;
        std::ranges::replace(name, ' ', '_');
        lines.add("# {}\no {}\n", describe(mesh), name);
        write_positions(lines, mesh);
        for (const auto& n : mesh.normals)
            lines.add("vn {:.6g} {:.6g} {:.6g}\n", n[0], n[1], n[2]);
        for (const auto& t : mesh.triangles)
            lines.add("f {0}//{0} {1}//{1} {2}//{2}\n", first + t[0], first + t[1], first + t[2]);
        first += mesh.positions.size();
    }
    lines.flush();
    file.finish();
}

}  // namespace isorast
