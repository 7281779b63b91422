#!/usr/bin/env bash
# Export every sample and open the files in FreeCAD, Blender, its newer module bpy, ezdxf, usd-core and Khronos's glTF
# validator, by the checkers in ../shared/clients. Needs .venv, as `make test` leaves it. Arguments: other photos to
# check in place of the samples, each with its camera beside it as .json. The last line counts what passed and failed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

checkers=../shared/clients
out=build/clients
python=.venv/bin/python
linecad=${LINECAD:-.venv/bin/linecad}
validator_version=2.0.0-dev.3.10
bpy_version=4.5.15
bpy_python=python3.11 # the only one that this bpy is made for
seconds_per_check=300

if [ ! -d "$checkers" ]; then
    echo "clients: left out, there is no folder $checkers"
    exit 0
fi

# --- the programs ----------------------------------------------------------------------------------------------------

packages=()
command -v freecadcmd >/dev/null || packages+=(freecad)
command -v blender >/dev/null || packages+=(blender)
command -v node >/dev/null || packages+=(nodejs)
command -v npm >/dev/null || packages+=(npm)
if [ ${#packages[@]} -gt 0 ] && ! .ci/install.sh "${packages[@]}"; then
    if [ "${CI:-}" = true ]; then
        exit 1
    fi
    echo "clients: left out, ${packages[*]} must be installed first"
    exit 0
fi

mkdir -p "$out"
export GLTF_VALIDATOR=$PWD/$out/node_modules/gltf-validator/index.js
if [ ! -f "$GLTF_VALIDATOR" ]; then
    echo "installing gltf-validator"
    npm install --prefix "$out" --silent --no-audit --no-fund "gltf-validator@$validator_version"
fi

# bpy reads USD, which Debian's Blender was built without. It brings a NumPy of its own, so it has its own environment.
bpy=${BPY_PYTHON:-$out/bpy/bin/python}
if [ ! -x "$bpy" ] || ! "$bpy" -c 'import bpy' >/dev/null 2>&1; then
    echo "installing bpy"
    if ! { "$bpy_python" -m venv "$out/bpy" && "$out/bpy/bin/python" -m pip install -qq --disable-pip-version-check \
        "bpy==$bpy_version"; } >"$out/bpy.log" 2>&1; then
        tail -n 5 "$out/bpy.log"
        echo "clients: bpy could not be installed, so Blender cannot open USD"
        if [ "${CI:-}" = true ]; then
            exit 1
        fi
        bpy=
    fi
fi

# --- the checks ------------------------------------------------------------------------------------------------------

passed=0
failed=0
log=$out/log.txt

# check NAME COMMAND...: a checker has passed when it exits with 0 and says CHECK OK.
check() {
    local name=$1 verdict
    shift
    if timeout "$seconds_per_check" "$@" >"$log" 2>&1 </dev/null && verdict=$(tr -d '\r' <"$log" | grep -a '^CHECK OK'); then
        passed=$((passed + 1))
        echo "ok      $name: ${verdict#CHECK OK }"
    else
        failed=$((failed + 1))
        echo "FAILED  $name"
        tail -n 30 "$log"
    fi
}

check_sample() {
    local photo=$1 name folder camera=() suffix outputs=() again="" expected picture textures render
    name=$(basename "${photo%.*}")
    folder=$out/$name
    expected=$folder/expect.json
    rm -rf "$folder"
    mkdir -p "$folder"
    if [ -f "${photo%.*}.json" ]; then
        camera=(--camera "${photo%.*}.json")
    fi
    for suffix in json dxf step glb usda usdc usdz obj ply stl fspy png; do
        outputs+=(-o "$folder/$name.$suffix")
        again+=" -o '{OUT}/$name.$suffix'"
    done
    if ! timeout "$seconds_per_check" "$linecad" convert "$photo" "${camera[@]}" "${outputs[@]}" >"$log" 2>&1; then
        failed=$((failed + 1))
        echo "FAILED  $name: linecad convert"
        tail -n 30 "$log"
        return
    fi
    "$python" "$checkers/expect.py" "$folder/$name.json" "$expected"
    # The photo as linecad measured it, straightened, is what a render through the camera must look like.
    picture=$folder/photo.jpg
    "$python" - "$folder/$name.fspy" "$picture" <<'PYTHON'
import struct, sys
data = open(sys.argv[1], "rb").read()
open(sys.argv[2], "wb").write(data[16 + struct.unpack_from("<I", data, 8)[0] :])
PYTHON
    # Textures are looked for where there are any; without them nothing can be rendered that looks like the photo.
    textures=(--textures no)
    render=()
    if grep -aq '"images"' "$folder/$name.glb"; then
        textures=(--textures yes)
        render=(--photo "$picture" --render)
    fi

    check "$name.dxf, ezdxf" "$python" "$checkers/check_dxf.py" "$folder/$name.dxf" "$expected"
    for suffix in usda usdc usdz; do
        check "$name.$suffix, usd-core" "$python" "$checkers/check_usd.py" "$folder/$name.$suffix" "$expected"
    done
    check "$name.glb, Khronos" node "$checkers/check_gltf.mjs" "$folder/$name.glb" "$expected"
    check "$name.step, FreeCAD" bash "$checkers/check_freecad.sh" "$folder/$name.step" "$expected" --gui
    check "$name.dxf, FreeCAD" bash "$checkers/check_freecad.sh" "$folder/$name.dxf" "$expected"
    check "$name.glb, Blender" blender -b --factory-startup --python-exit-code 3 \
        --python "$checkers/check_blender.py" -- "$folder/$name.glb" "$expected" "${textures[@]}" \
        "${render[@]}" ${render:+"$folder/render-glb.png"}
    if [ -n "$bpy" ]; then
        check "$name.glb, bpy" "$bpy" "$checkers/check_blender.py" "$folder/$name.glb" "$expected" "${textures[@]}"
        for suffix in usda usdc usdz; do
            local shown=()
            if [ $suffix = usdz ]; then
                shown=("${render[@]}" ${render:+"$folder/render-usd.png"})
            fi
            check "$name.$suffix, bpy" "$bpy" "$checkers/check_blender.py" "$folder/$name.$suffix" "$expected" \
                "${textures[@]}" "${shown[@]}"
        done
    fi
    check "$name, every format three times" bash "$checkers/check_determinism.sh" \
        "'$linecad' export '$folder/$name.json' --photo '$photo' ${camera[*]} $again"
}

shopt -s nullglob
photos=("$@")
if [ $# = 0 ]; then
    photos=(samples/*.jpg samples/*.jpeg samples/*.png samples/*.tif)
fi
for photo in "${photos[@]}"; do
    check_sample "$photo"
done

echo "clients: $passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
