# A toolchain file for another processor: Debian's cross compiler for it, and QEMU to run what was
# compiled. MACHINE is the first part of the compiler's name: aarch64, riscv64 or s390x.
#
#   cmake -B build/elsewhere/aarch64 -DMACHINE=aarch64 -DPENDCORE_TESTS=ON
#         -DCMAKE_TOOLCHAIN_FILE=cpp/cmake/machines/debian.cmake
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR ${MACHINE})
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES MACHINE)
set(CMAKE_CXX_COMPILER ${MACHINE}-linux-gnu-g++-12)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-${MACHINE}-static -L /usr/${MACHINE}-linux-gnu)
if(MACHINE STREQUAL "riscv64") # has no instruction for atomic bytes, of which GCC 12 asks a library
  set(CMAKE_CXX_STANDARD_LIBRARIES -latomic)
endif()
