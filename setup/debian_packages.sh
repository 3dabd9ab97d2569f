#!/bin/sh
# Installs what is missing of the Debian packages that a step of the Makefile needs. When nothing is
# missing it does nothing and asks for no password. The step can do without the packages after
# `also`; they are installed with the others so that a password is asked for only once.
#
#   setup/debian_packages.sh [python] [compiler] [eigen] [doctest] [benchmark] [boost] [sundials]
#                            [valgrind] [octave] [pandoc] [ffmpeg] [chromium] [aarch64] [riscv64]
#                            [s390x] [wasm32] [clang] [also ...]
set -eu

python=${PYTHON:-python3}
needed=
also=
kind=needed

stop() {
    printf '%s\n' "" "$@" "" >&2
    exit 1
}

miss() {
    if [ $kind = needed ]; then needed="$needed $1"; else also="$also $1"; fi
}

look_at_python() {
    "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null ||
        stop "pendcore needs Python 3.11 or newer: $python is missing or older. With another one:" \
            "    make PYTHON=/path/to/python3.11 demo"
    before=$needed
    "$python" -c 'import ensurepip, venv' 2>/dev/null || miss python3-venv
    headers=$("$python" -c 'import sysconfig; print(sysconfig.get_path("include"))')
    [ -e "$headers/Python.h" ] || miss python3-dev
    home=$("$python" -c 'import sys; print(sys.base_prefix)')
    [ "$needed" = "$before" ] || [ "$home" = /usr ] ||
        stop "$python has no ensurepip or no Python.h, and is not Debian's own, which packages" \
            "could complete. With Debian's:" "    make PYTHON=/usr/bin/python3 demo"
}

for thing in "$@"; do
    case $thing in
        also) kind=also ;;
        python) look_at_python ;;
        compiler) command -v g++ >/dev/null || miss g++ ;;
        eigen) [ -e /usr/include/eigen3/Eigen/Core ] || miss libeigen3-dev ;;
        doctest) [ -e /usr/include/doctest/doctest.h ] || miss doctest-dev ;;
        benchmark) [ -e /usr/include/benchmark/benchmark.h ] || miss libbenchmark-dev ;;
        boost) [ -e /usr/include/boost/numeric/odeint.hpp ] || miss libboost-dev ;;
        sundials) [ -e /usr/include/arkode/arkode_erkstep.h ] || miss libsundials-dev ;;
        valgrind) command -v valgrind >/dev/null || miss valgrind ;;
        octave) command -v octave-cli >/dev/null || miss octave ;;
        aarch64 | riscv64 | s390x) # to compile for that processor, and to run what was compiled
            command -v "$thing-linux-gnu-g++-12" >/dev/null || miss "g++-12-$thing-linux-gnu"
            command -v "qemu-$thing-static" >/dev/null || miss qemu-user-static
            ;;
        clang) command -v clang++-22 >/dev/null || miss clang-22 ;;
        wasm32) # clang with its WebAssembly libraries, and Node
            { command -v clang++-22 && command -v wasm-ld-22; } >/dev/null || miss "clang-22 lld-22"
            [ -e /usr/lib/llvm-22/lib/wasm32-wasi/libc++abi.a ] ||
                miss "wasi-libc libc++-22-dev-wasm32 libc++abi-22-dev-wasm32 \
                    libclang-rt-22-dev-wasm32"
            command -v node >/dev/null || miss nodejs
            ;;
        pandoc) command -v pandoc >/dev/null || miss pandoc ;;
        ffmpeg) command -v ffmpeg >/dev/null || miss ffmpeg ;;
        chromium) # and what drives it
            { command -v chromium && command -v chromedriver; } >/dev/null ||
                miss "chromium chromium-driver"
            ;;
        *) stop "debian_packages.sh: no '$thing' is known" ;;
    esac
done
packages="$needed$also"
[ -n "$packages" ] || exit 0

if ! command -v apt-get >/dev/null; then
    may=no
elif [ "$(id -u)" = 0 ]; then
    may=yes as=
elif command -v sudo >/dev/null && { sudo -n true 2>/dev/null || { [ -t 0 ] && sudo -v; }; }; then
    may=yes as=sudo
else
    may=no
fi

if [ $may = yes ]; then
    echo "installing Debian packages:$packages"
    $as apt-get update -qq
    # shellcheck disable=SC2086 # a list of words
    $as env DEBIAN_FRONTEND=noninteractive \
        apt-get install -y -qq --no-install-recommends $packages >/dev/null
elif [ -n "$needed" ]; then
    stop "Packages are missing, and you are neither root nor may use sudo to install them. Ask" \
        "whoever administers this machine for (names as in Debian 12)" \
        "    apt-get install$packages" "and run make again."
else
    echo "going on without, for want of the right to install:$packages"
fi
