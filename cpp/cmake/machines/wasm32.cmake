# A toolchain file for WebAssembly: Debian's clang with the C library for WASI, and Node to run what
# was compiled. Exceptions are not compiled: a throw ends the program, or calls the host
# (cpp/wasm/exceptions.cpp).
#
#   cmake -B build/wasm -DPENDCORE_TESTS=ON
#         -DCMAKE_TOOLCHAIN_FILE=cpp/cmake/machines/wasm32.cmake
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_BUILD_TYPE MinSizeRel CACHE STRING "Kind of build")
set(CMAKE_CXX_COMPILER clang++-22)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
# Nothing may rewrite the module after the linker: the loader finds the calls of fma by their form.
set(CMAKE_CXX_FLAGS_INIT
    "-Wno-deprecated -msimd128 -fexceptions -fignore-exceptions -D_WASI_EMULATED_PROCESS_CLOCKS")
set(CMAKE_EXE_LINKER_FLAGS_INIT "--no-wasm-opt -mexec-model=reactor")
set(CMAKE_CXX_STANDARD_LIBRARIES "-lwasi-emulated-process-clocks")
set(CMAKE_EXECUTABLE_SUFFIX .wasm)
