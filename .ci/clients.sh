#!/usr/bin/env bash
# Export every sample and open the files in FreeCAD, Blender, its newer module bpy, ezdxf, usd-core, ifcopenshell with
# its validator, rhino3dm and Khronos's glTF validator, and the drawings in poppler and Inkscape, by the checkers in
# tests/clients. Then show that the checkers notice faults, and let the add-on for Blender and the macro for FreeCAD
# convert a sample. Arguments: other photos to check in place of the samples, each with its camera beside it as .json.
# The last line counts what passed and failed. Needs .venv, as `make test` leaves it, or another Python with linecad's
# libraries in PYTHON; LINECAD names another linecad than that Python's, BPY_PYTHON a Python that has bpy.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

checkers=tests/clients
out=build/clients
python=${PYTHON:-.venv/bin/python}
linecad=("$python" -m linecad)
if [ -n "${LINECAD:-}" ]; then
    linecad=("$LINECAD")
fi
validator_version=2.0.0-dev.3.10
bpy_version=4.5.15
bpy_python=python3.11 # the only one that this bpy is made for
seconds_per_check=300

# --- the programs ----------------------------------------------------------------------------------------------------

packages=()
command -v freecadcmd >/dev/null || packages+=(freecad)
command -v blender >/dev/null || packages+=(blender)
command -v node >/dev/null || packages+=(nodejs)
command -v npm >/dev/null || packages+=(npm)
command -v inkscape >/dev/null || packages+=(inkscape)
command -v pdftoppm >/dev/null || packages+=(poppler-utils)
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

# FreeCAD opens IFC with ifcopenshell, which Debian does not have. FreeCAD runs in Debian's own Python; the one of linecad
# must be of the same version for this.
freecad_libraries=$out/freecad-libraries
if [ ! -d "$freecad_libraries/ifcopenshell" ]; then
    echo "installing ifcopenshell for FreeCAD"
    "$python" -m pip install -qq --disable-pip-version-check --no-deps -c constraints.txt \
        --target "$freecad_libraries" ifcopenshell typing_extensions
fi

# --- the checks ------------------------------------------------------------------------------------------------------

passed=0
failed=0
log=$out/log.txt

report_pass() {
    passed=$((passed + 1))
    echo "ok      $1"
}

report_failure() {
    failed=$((failed + 1))
    echo "FAILED  $1"
    tail -n 30 "$log"
}

# check NAME COMMAND...: a checker has passed when it exits with 0 and says CHECK OK.
check() {
    local name=$1 verdict
    shift
    if timeout "$seconds_per_check" "$@" >"$log" 2>&1 </dev/null && verdict=$(grep -a '^CHECK OK' "$log"); then
        report_pass "$name: ${verdict#CHECK OK }"
    else
        report_failure "$name"
    fi
}

# check_fault NAME COMMAND...: a checker has noticed a fault when it fails and says CHECK FAILED.
check_fault() {
    local name=$1 verdict
    shift
    if timeout "$seconds_per_check" "$@" >"$log" 2>&1 </dev/null; then
        report_failure "$name was not noticed"
    elif verdict=$(grep -a '^CHECK FAILED' "$log"); then
        report_pass "$name is noticed: $(cut -c 15-110 <<<"$verdict")"
    else
        report_failure "$name"
    fi
}

in_blender=(blender -b --factory-startup --python-exit-code 3 --python "$checkers/check_blender.py" --)
in_bpy=("$bpy" "$checkers/check_blender.py")
in_freecad=("$python" "$checkers/check_freecad.py" --libraries "$freecad_libraries")
by_khronos=(node "$checkers/check_gltf.mjs")

check_photo() {
    local photo=$1 name folder made camera=() suffix outputs=() again=() expected textures=() render_glb=() render_usd=()
    name=$(basename "${photo%.*}")
    folder=$out/$name
    made=$folder/$name
    expected=$folder/expectation.json
    rm -rf "$folder"
    mkdir -p "$folder"
    if [ -f "${photo%.*}.json" ]; then
        camera=(--camera "${photo%.*}.json")
    fi
    for suffix in json dxf step ifc 3dm skp glb usda usdc usdz obj ply stl fspy png {elevation,plan}.{pdf,svg,dxf} \
        elevation.tif; do
        outputs+=(-o "$made.$suffix")
        again+=(-o "{OUT}/$name.$suffix")
    done
    if ! timeout "$seconds_per_check" "${linecad[@]}" convert "$photo" "${camera[@]}" "${outputs[@]}" >"$log" 2>&1; then
        report_failure "$name: linecad convert"
        return
    fi
    if ! "$python" "$checkers/expectation.py" "$made.json" "$expected" >"$log" 2>&1; then
        report_failure "$name: its scene file"
        return
    fi
    # Textures are looked for where there are any; without them nothing can be rendered that looks like the photo. The
    # photo as linecad measured it, straightened, is what a render through the camera must look like.
    if grep -aq '"images"' "$made.glb"; then
        "$python" "$checkers/fspy_photo.py" "$made.fspy" "$folder/photo.jpg"
        textures=(--textures)
        render_glb=(--photo "$folder/photo.jpg" --render "$folder/render-glb.png")
        render_usd=(--photo "$folder/photo.jpg" --render "$folder/render-usd.png")
    fi

    check "$name.dxf, ezdxf" "$python" "$checkers/check_dxf.py" "$made.dxf" "$expected"
    for suffix in usda usdc usdz; do
        check "$name.$suffix, usd-core" "$python" "$checkers/check_usd.py" "$made.$suffix" "$expected"
    done
    check "$name.glb, Khronos" "${by_khronos[@]}" "$made.glb" "$expected"
    check "$name.step, FreeCAD" "${in_freecad[@]}" "$made.step" "$expected"
    check "$name.step, FreeCAD" "${in_freecad[@]}" "$made.step" "$expected" --gui
    check "$name.dxf, FreeCAD" "${in_freecad[@]}" "$made.dxf" "$expected"
    check "$name.ifc, FreeCAD" "${in_freecad[@]}" "$made.ifc" "$expected"
    check "$name.ifc, ifcopenshell" "$python" "$checkers/check_ifc.py" "$made.ifc" "$expected"
    check "$name.3dm, rhino3dm" "$python" "$checkers/check_rhino.py" "$made.3dm" "$expected"
    check "$name.glb, Blender" "${in_blender[@]}" "$made.glb" "$expected" "${textures[@]}" "${render_glb[@]}"
    if [ -n "$bpy" ]; then
        check "$name.glb, bpy" "${in_bpy[@]}" "$made.glb" "$expected" "${textures[@]}"
        check "$name.usda, bpy" "${in_bpy[@]}" "$made.usda" "$expected" "${textures[@]}"
        check "$name.usdc, bpy" "${in_bpy[@]}" "$made.usdc" "$expected" "${textures[@]}"
        check "$name.usdz, bpy" "${in_bpy[@]}" "$made.usdz" "$expected" "${textures[@]}" "${render_usd[@]}"
    fi
    check "$name.elevation, poppler and Inkscape" \
        "$python" "$checkers/check_drawing.py" "$made.elevation.pdf" "$made.elevation.svg"
    check "$name.plan, poppler and Inkscape" \
        "$python" "$checkers/check_drawing.py" "$made.plan.pdf" "$made.plan.svg"
    check "$name, every format three times" "$python" "$checkers/check_same.py" \
        "${linecad[@]}" export "$made.json" --photo "$photo" "${camera[@]}" "${again[@]}"
}

# The same scene with a known scale stands on its ground, if it has one.
check_metric() {
    local name folder metric expected suffix outputs=()
    name=$(basename "${1%.*}")
    folder=$out/$name
    metric=$folder/metric
    expected=$metric-expectation.json
    if [ ! -f "$folder/expectation.json" ]; then
        return
    fi
    sed 's/"metres_per_unit": null/"metres_per_unit": 1.7/' "$folder/$name.json" >"$metric.json"
    for suffix in dxf step ifc 3dm glb usdc; do
        outputs+=(-o "$metric.$suffix")
    done
    if ! "${linecad[@]}" export "$metric.json" "${outputs[@]}" >"$log" 2>&1 ||
        ! "$python" "$checkers/expectation.py" "$metric.json" "$expected" >"$log" 2>&1; then
        report_failure "$name in metres: linecad export"
        return
    fi
    check "$name.dxf in metres, ezdxf" "$python" "$checkers/check_dxf.py" "$metric.dxf" "$expected"
    check "$name.usdc in metres, usd-core" "$python" "$checkers/check_usd.py" "$metric.usdc" "$expected"
    check "$name.glb in metres, Khronos" "${by_khronos[@]}" "$metric.glb" "$expected"
    check "$name.glb in metres, Blender" "${in_blender[@]}" "$metric.glb" "$expected"
    check "$name.step in metres, FreeCAD" "${in_freecad[@]}" "$metric.step" "$expected"
    check "$name.ifc in metres, FreeCAD" "${in_freecad[@]}" "$metric.ifc" "$expected"
    check "$name.3dm in metres, rhino3dm" "$python" "$checkers/check_rhino.py" "$metric.3dm" "$expected"
}

# A checker that never fails shows nothing. Those of ezdxf, usd-core, ifcopenshell and rhino3dm have tests of their own
# in tests/clients.
check_faults() {
    local name folder made fault wrong broken
    name=$(basename "${1%.*}")
    folder=$out/$name
    made=$folder/$name
    wrong=$folder/wrong.json
    broken=$folder/broken.glb
    if [ ! -f "$folder/expectation.json" ]; then
        return
    fi
    for fault in moved-line missing-face wrong-camera wrong-colour; do
        "$python" "$checkers/faults.py" $fault "$folder/expectation.json" "$wrong"
        check_fault "$fault, Khronos" "${by_khronos[@]}" "$made.glb" "$wrong"
        check_fault "$fault, Blender" "${in_blender[@]}" "$made.glb" "$wrong"
        if [ $fault != wrong-camera ]; then # it is no part of a STEP file
            check_fault "$fault, FreeCAD" "${in_freecad[@]}" "$made.step" "$wrong" --gui
        fi
        if [ -n "$bpy" ] && [ $fault != wrong-colour ]; then # Blender leaves out the colours of USD's lines
            check_fault "$fault, bpy" "${in_bpy[@]}" "$made.usdc" "$wrong"
        fi
    done
    for fault in moved-line missing-wall missing-hole; do
        "$python" "$checkers/faults.py" $fault "$folder/expectation.json" "$wrong"
        check_fault "$fault in IFC, FreeCAD" "${in_freecad[@]}" "$made.ifc" "$wrong"
    done
    check_fault "another drawing, poppler and Inkscape" \
        "$python" "$checkers/check_drawing.py" "$made.elevation.pdf" "$made.plan.svg"
    "$python" "$checkers/faults.py" wrong-bounds "$made.glb" "$broken"
    check_fault "wrong-bounds, Khronos" "${by_khronos[@]}" "$broken" "$folder/expectation.json"
}

# Houses that stand turned against each other. FreeCAD measures the angles between their walls.
check_turned() {
    local folder=$out/turned made=$out/turned/turned expected=$out/turned/expectation.json suffix outputs=()
    rm -rf "$folder"
    mkdir -p "$folder"
    "$python" "$checkers/turned_houses.py" "$made.json"
    for suffix in dxf step ifc 3dm glb usda usdc usdz; do
        outputs+=(-o "$made.$suffix")
    done
    if ! "${linecad[@]}" export "$made.json" "${outputs[@]}" >"$log" 2>&1 ||
        ! "$python" "$checkers/expectation.py" "$made.json" "$expected" >"$log" 2>&1; then
        report_failure "turned houses: linecad export"
        return
    fi
    check "turned.dxf, ezdxf" "$python" "$checkers/check_dxf.py" "$made.dxf" "$expected"
    for suffix in usda usdc usdz; do
        check "turned.$suffix, usd-core" "$python" "$checkers/check_usd.py" "$made.$suffix" "$expected"
    done
    check "turned.glb, Khronos" "${by_khronos[@]}" "$made.glb" "$expected"
    check "turned.glb, Blender" "${in_blender[@]}" "$made.glb" "$expected"
    check "turned.step, FreeCAD" "${in_freecad[@]}" "$made.step" "$expected" --gui
    check "turned.dxf, FreeCAD" "${in_freecad[@]}" "$made.dxf" "$expected"
    check "turned.ifc, FreeCAD" "${in_freecad[@]}" "$made.ifc" "$expected"
    check "turned.3dm, rhino3dm" "$python" "$checkers/check_rhino.py" "$made.3dm" "$expected"
    if [ -n "$bpy" ]; then
        check "turned.usdc, bpy" "${in_bpy[@]}" "$made.usdc" "$expected"
    fi
    "$python" "$checkers/faults.py" wrong-turn "$expected" "$folder/wrong.json"
    check_fault "wrong-turn, FreeCAD" "${in_freecad[@]}" "$made.step" "$folder/wrong.json"
}

# The add-ons are installed from their files and run the command themselves; Blender keeps them in a home of their own.
# The faults: a camera that looks aside, in a single file as older Blenders take it too, and a confidence that hides
# nothing.
check_addons() {
    local folder=$PWD/$out/addons command=${LINECAD:-$PWD/$out/addons/linecad} program
    rm -rf "$folder"
    mkdir -p "$folder"
    if [ -z "${LINECAD:-}" ]; then
        printf '#!/usr/bin/env bash\nPYTHONPATH=%q exec %q -m linecad "$@"\n' \
            "$PWD" "$(realpath -s "$(command -v "$python")")" >"$command"
        chmod +x "$command"
    fi
    for program in blender freecad; do
        if ! "${linecad[@]}" addon $program -o "$folder" >"$log" 2>&1; then
            report_failure "linecad addon $program"
            return
        fi
    done
    for program in blender bpy freecad fault; do
        mkdir "$folder/$program"
        cp samples/courtyard.jpg samples/courtyard.json "$folder/$program"
    done
    "$python" -m zipfile -e "$folder/linecad-blender.zip" "$folder/fault"
    sed 's/lens.shift_x = (/lens.shift_x = -(/' "$folder/fault/linecad/__init__.py" >"$folder/fault/linecad.py"
    sed 's/probability >= confidence/True/' "$folder/linecad.FCMacro" >"$folder/fault/linecad.FCMacro"

    addon() {
        "$1" "$2" env XDG_CONFIG_HOME="$folder/$3/home" BROWSER=true "${@:5}" "$4" "$command" \
            "$folder/$3/courtyard.jpg" "$folder/$3/courtyard.json"
    }
    local by_blender=(blender -b --factory-startup --python-exit-code 3 --python "$checkers/check_blender_addon.py" --)
    local by_freecad=("$python" "$checkers/check_freecad_macro.py")
    addon check "the add-on, Blender" blender "$folder/linecad-blender.zip" "${by_blender[@]}"
    if [ -n "$bpy" ]; then
        addon check "the extension, bpy" bpy "$folder/linecad-blender.zip" "$bpy" "$checkers/check_blender_addon.py"
    fi
    addon check "the macro, FreeCAD" freecad "$folder/linecad.FCMacro" "${by_freecad[@]}"
    addon check_fault "wrong-lens, add-on" fault "$folder/fault/linecad.py" "${by_blender[@]}"
    rm -f "$folder/fault/courtyard.jpg.corrections.json"
    addon check_fault "wrong-confidence, macro" fault "$folder/fault/linecad.FCMacro" "${by_freecad[@]}"
}

# The Python that the guides show, in the programs that they are about. tests/linecad/cli/test_guides.py runs the rest.
check_guides() {
    local folder=$out/guides made=$out/guides/facade guide=docs/guide
    rm -rf "$folder"
    mkdir -p "$folder"
    cp samples/courtyard.jpg "$made.jpg"
    if ! "${linecad[@]}" convert "$made.jpg" -o "$made.json" -o "$made.glb" -o "$made.step" >"$log" 2>&1 ||
        ! "$python" "$checkers/expectation.py" "$made.json" "$folder/expectation.json" >"$log" 2>&1; then
        report_failure "guides: linecad convert"
        return
    fi
    check "the guide's Python, FreeCAD" "${in_freecad[@]}" "$made.step" "$folder/expectation.json" \
        --guide "$guide/freecad.md"
    check "the guide's Python, Blender" blender -b --factory-startup --python-exit-code 3 \
        --python "$checkers/guide_in_blender.py" -- "$guide/blender.md" "$made.glb" "$folder/expectation.json"
    if [ -n "$bpy" ]; then
        check "the guide's Python, bpy" "$bpy" "$checkers/guide_in_blender.py" "$guide/blender.md" "$made.glb" \
            "$folder/expectation.json"
    fi
}

shopt -s nullglob
photos=("$@")
if [ $# = 0 ]; then
    photos=(samples/*.jpg samples/*.jpeg samples/*.png samples/*.tif)
fi
for photo in "${photos[@]}"; do
    check_photo "$photo"
done
check_metric "${photos[0]}"
check_faults "${photos[0]}"
check_turned
check_addons
check_guides

echo "clients: $passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
