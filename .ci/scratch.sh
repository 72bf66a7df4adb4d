# For scripts here to source: a folder that is gone when they end, and what several of them do in it.

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# Run something, and show what it has said only if it fails.
log=$folder/log
quietly() {
    "$@" > "$log" 2>&1 || { cat "$log" >&2; exit 1; }
}

# Make a source distribution with a Python that has setuptools, and put what it holds into $folder/source.
unpack_source() {
    quietly "$1" -c "from setuptools import build_meta; build_meta.build_sdist('$folder')"
    mkdir "$folder/source"
    tar -xzf "$folder"/openmm_helfrich-*.tar.gz -C "$folder/source" --strip-components=1
}
