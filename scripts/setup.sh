#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs what this machine lacks for the build ("setup.sh build") or also for the tests ("setup.sh test"),
# and sees to a Vulkan driver with mesh shaders. What is there already stays as it is; a second run needs
# no network. Afterwards .cache/env.sh holds the environment that finds the driver.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

BUILD_PACKAGES=(g++ cmake ninja-build libvulkan-dev glslang-tools libglm-dev libcli11-dev libfmt-dev
    nlohmann-json3-dev libmeshoptimizer-dev libnifti-dev libpng-dev zlib1g-dev)
TEST_PACKAGES=(libgtest-dev vulkan-validationlayers spirv-tools libinsighttoolkit5-dev python3-nibabel
    python3-numpy python3-vtk9 xvfb admesh clang-format-19 clang-tidy-19)
OLDEST_MESA=24  # the first whose lavapipe has VK_EXT_mesh_shader
CACHE=$PWD/.cache

say() { echo "setup: $*"; }
fail() { echo "setup: $*" >&2; exit 1; }

# Run a command as root, or end with one line that names $packages, which were wanted.
as_root() {
    if [ "$(id -u)" = 0 ]; then
        "$@"
    elif command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then
        sudo "$@"
    else
        fail "packages are missing, and this is not root and has no usable sudo; as root, run:" \
            "apt-get install --no-install-recommends $packages"
    fi
}

apt_get() {
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y -o Dpkg::Use-Pty=0 \
        -o DPkg::Lock::Timeout=300 "$@" >>"$CACHE/apt.log" 2>&1
}

install_packages() {
    local packages=$*
    as_root true
    say "installing $packages"
    apt_get update || true  # a source that cannot be reached need not be the one that is needed
    apt_get install --no-install-recommends "$@" ||
        fail "apt-get install failed: $(grep '^E:' "$CACHE/apt.log" | tail -n 1) (see $CACHE/apt.log)"
}

# Install those of the named packages that are not installed.
require() {
    local missing
    mapfile -t missing < <(comm -23 <(printf '%s\n' "$@" | sort -u) \
        <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null |
            sed -n 's/^installed //p' | sort -u))
    if [ ${#missing[@]} -gt 0 ]; then install_packages "${missing[@]}"; fi
}

# --- A Vulkan driver with mesh shaders --------------------------------------------------------------

any_driver() {
    compgen -G "/usr/share/vulkan/icd.d/*.json" >/dev/null ||
        compgen -G "/usr/local/share/vulkan/icd.d/*.json" >/dev/null ||
        compgen -G "/etc/vulkan/icd.d/*.json" >/dev/null || [ -n "${VK_DRIVER_FILES:-}" ]
}

# Ask every driver, with the environment of .cache/env.sh; prints the first device that has mesh shaders.
mesh_shader_device() {
    if [ ! "$CACHE/mesh_shader_device" -nt scripts/mesh_shader_device.cpp ]; then
        c++ -std=c++20 scripts/mesh_shader_device.cpp -o "$CACHE/mesh_shader_device" -lvulkan
    fi
    (. "$CACHE/env.sh" && "$CACHE/mesh_shader_device")
}

# apt-get with the backports of the sources configured here, and with lists of its own: the system's stay as
# they are, and no root is needed.
backports_apt() { apt-get -qq -c "$CACHE/lavapipe/apt.conf" "$@" >>"$CACHE/apt.log" 2>&1; }

derive_backports() {
    local here=$CACHE/lavapipe codename=$1
    mkdir -p "$here/lists/partial" "$here/archives/partial" "$here/sources"
    # One-line entries (deb [options] URI SUITE components...), then stanzas with a field per line.
    cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null |
        sed -nE "s/^(deb[[:space:]].*[[:space:]]$codename)([[:space:]].*)$/\1-backports\2/p" \
            >"$here/sources/backports.list" || true
    for file in /etc/apt/sources.list.d/*.sources; do
        if [ -f "$file" ]; then awk -v suite="$codename" 'BEGIN { RS = ""; ORS = "\n\n" }
            $0 ~ "(^|\n)Suites:[^\n]*[ \t]" suite "([ \t\n]|$)" {
                sub(/Suites:[^\n]*/, "Suites: " suite "-backports"); print
            }' "$file"; fi
    done >"$here/sources/backports.sources"
    cat >"$here/apt.conf" <<END
Dir::Etc::SourceList "/dev/null";
Dir::Etc::SourceParts "$here/sources";
Dir::State::Lists "$here/lists";
Dir::Cache "$here";
Dir::Cache::Archives "$here/archives";
APT::Sandbox::User "root";
#clear APT::Update::Post-Invoke;
#clear APT::Update::Post-Invoke-Success;
END
}

download_lavapipe() {
    local here=$CACHE/lavapipe codename needed
    codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
    rm -rf "$here" && derive_backports "$codename"
    # A third party's source has no backports and fails; what counts is the download.
    backports_apt update || true
    (cd "$here" && backports_apt download "mesa-vulkan-drivers/$codename-backports") ||
        fail "no Vulkan driver here has mesh shaders, and no mesa-vulkan-drivers of $codename-backports" \
            "can be had from the package sources configured; install a driver with VK_EXT_mesh_shader" \
            "(Mesa $OLDEST_MESA or newer, or a GPU's own); see $CACHE/apt.log"
    dpkg-deb --fsys-tarfile "$here"/mesa-vulkan-drivers_*.deb |
        tar -x -C "$here" --wildcards './usr/lib/*/libvulkan_lvp.so' './usr/share/vulkan/icd.d/lvp_icd*'
    # What it links to; the distribution's own Mesa brings the same, so mostly nothing is missing.
    read -ra needed < <(dpkg-deb -f "$here"/mesa-vulkan-drivers_*.deb Depends |
        sed -E 's/\([^)]*\)//g; s/\|[^,]*//g; s/:any//g; s/,/ /g')
    require "${needed[@]}"
    say "no Vulkan driver here has mesh shaders: unpacked lavapipe" \
        "$(dpkg-deb -f "$here"/mesa-vulkan-drivers_*.deb Version) of $codename-backports into $here"
    rm -rf "$here"/*.deb "$here/lists" "$here/archives" "$here"/*pkgcache.bin
}

# Point the loader at the unpacked driver beside all others, so that a GPU stays visible, but in place of the
# distribution's own older lavapipe.
write_environment() {
    local library manifest
    library=$(echo "$CACHE"/lavapipe/usr/lib/*/libvulkan_lvp.so)
    manifest=$CACHE/lavapipe/isorast_lavapipe.json
    # Escaped as a JSON string, then as a replacement of sed.
    library=$(printf '%s' "$library" | sed -e 's/[\\"]/\\&/g' -e 's/[\\&#]/\\&/g')
    sed -E "s#(\"library_path\": *)\"[^\"]*\"#\1\"$library\"#" \
        "$CACHE"/lavapipe/usr/share/vulkan/icd.d/lvp_icd*.json >"$manifest"
    cat >"$CACHE/env.sh" <<END
# Written by scripts/setup.sh: finds the lavapipe that it unpacked.
export VK_ADD_DRIVER_FILES=$(printf '%q' "$manifest")"\${VK_ADD_DRIVER_FILES:+:\$VK_ADD_DRIVER_FILES}"
export VK_LOADER_DRIVERS_DISABLE="lvp_icd*\${VK_LOADER_DRIVERS_DISABLE:+,\$VK_LOADER_DRIVERS_DISABLE}"
END
}

ensure_mesh_shaders() {
    [ -f "$CACHE/env.sh" ] || : >"$CACHE/env.sh"
    if mesh_shader_device >/dev/null; then return; fi
    if [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ]; then
        say "no driver named by VK_DRIVER_FILES has mesh shaders; left as it is, since it was chosen"
        return
    fi
    local candidate
    candidate=$(apt-cache policy mesa-vulkan-drivers | sed -n 's/^ *Candidate: *//p')
    if [ "${candidate%%.*}" -ge "$OLDEST_MESA" ] 2>/dev/null; then
        say "no Vulkan driver here has mesh shaders, but mesa-vulkan-drivers $candidate has them"
        install_packages mesa-vulkan-drivers
    else
        compgen -G "$CACHE/lavapipe/usr/lib/*/libvulkan_lvp.so" >/dev/null || download_lavapipe
        write_environment
    fi
    mesh_shader_device >/dev/null ||
        fail "the lavapipe brought in does not start; remove $CACHE and try again, or look at: VK_LOADER_DEBUG=all" \
            "$CACHE/mesh_shader_device after: . $CACHE/env.sh"
}

main() {
    mkdir -p "$CACHE"
    local wanted=("${BUILD_PACKAGES[@]}")
    case "${1:-}" in
        build) ;;
        test) wanted+=("${TEST_PACKAGES[@]}") ;;
        *) fail "expected 'build' or 'test', found '${1:-}'" ;;
    esac
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        : >"$CACHE/env.sh"
        say "no apt-get here, so nothing is installed; needed are (Debian's names): ${wanted[*]}," \
            "and a Vulkan driver with VK_EXT_mesh_shader (Mesa $OLDEST_MESA or newer, or a GPU's own)"
        return
    fi
    any_driver || wanted+=(mesa-vulkan-drivers)
    require "${wanted[@]}"
    ensure_mesh_shaders
}

main "$@"
