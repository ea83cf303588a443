// SPDX-License-Identifier: MIT
// Other libraries' readings of the same files, to compare ours with.
#pragma once
#include <isorast/volume.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace isorast::test {

// Lines "name word word ..." that an oracle prints.
using Dump = std::map<std::string, std::vector<std::string>>;

// Whether ITK could be had when this was built; without it the comparisons below do nothing.
bool has_itk();
// What ITK reads, or nothing when it cannot.
std::optional<Dump> itk_dump(const std::string& path);
// Loads path and compares dimensions, time steps, type, affine and every voxel with ITK.
void expect_like_itk(const std::string& path);

// What nibabel reads from each file, by path; empty where it is not installed.
std::map<std::string, Dump> nibabel_dumps(const std::vector<std::string>& paths);

// Compares everything that nibabel says with what we load. It invents an affine where the file
// gives none: affines are compared only where qform or sform is set.
void expect_like_nibabel(const std::string& path, const Dump& dump);

// Dimensions, type and every voxel of all time steps; `volume` is the first step.
void expect_same_voxels(const Volume& volume, const std::string& path, const Dump& dump);

}  // namespace isorast::test
