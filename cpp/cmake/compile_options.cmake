# pendcore_compile_options(target): arithmetic, warnings and sanitizers, the same for every target.

# Same bits everywhere: what the source says is what the processor computes. No multiply and add is
# contracted, nothing is reassociated, and no -march flag: newer instruction sets are chosen while
# running. The last two flags change no value; they free sqrt of errno and let selects be blends.
set(pendcore_arithmetic -ffp-contract=off -fno-fast-math -fno-math-errno
                        -fno-trapping-math)

# GCC 12 moves a double through an MMX register where it runs out of others, and leaves it so: after
# that, every long double of the process is a NaN, and with it LAPACK.
include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-mno-mmx PENDCORE_KNOWS_MMX)
if(PENDCORE_KNOWS_MMX)
  list(APPEND pendcore_arithmetic -mno-mmx)
endif()

# The kernels say themselves what is unrolled; -O3 makes the steps, and the series of three links,
# slower (GCC 12).
set(pendcore_optimisation $<$<CONFIG:Release>:-O2>)

# Two things make GCC compile an eighth faster: it collects its garbage later, for 200 MB more of
# memory, and leaves out a pass that eliminates what tree passes have eliminated before it.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND pendcore_optimisation
       $<$<CONFIG:Release>:--param=ggc-min-heapsize=500000> $<$<CONFIG:Release>:-fno-gcse>)
endif()

set(pendcore_warnings
    -Wall -Wextra -Wpedantic -Wshadow -Wold-style-cast -Wconversion -Wno-sign-conversion
    -Wnon-virtual-dtor -Woverloaded-virtual -Wundef
    # Packs wider than the baseline's registers never cross the border of a compiled file.
    -Wno-psabi)

# The clones have one source: under a sanitizer, which slows compilation, one is enough. So is -Og
# in their presets: half the compilation of -O1.
if(PENDCORE_SANITIZE)
  set(PENDCORE_BASELINE_ONLY ON)
endif()

function(pendcore_compile_options target)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    message(FATAL_ERROR "pendcore is built with GCC or clang, not with ${CMAKE_CXX_COMPILER_ID}")
  endif()
  target_compile_options(${target} PRIVATE ${pendcore_arithmetic} ${pendcore_optimisation}
                                           ${pendcore_warnings})
  if(PENDCORE_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  # The headers are compiled by whoever includes them: there, too, nothing is contracted.
  target_compile_options(${target} INTERFACE -ffp-contract=off)
  if(PENDCORE_BASELINE_ONLY)
    target_compile_definitions(${target} PUBLIC PENDCORE_BASELINE_ONLY)
  endif()
  if(PENDCORE_SANITIZE)
    # -g1, which says lines and no variables: following those takes two thirds of the compilation.
    set(sanitize -fsanitize=${PENDCORE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_compile_options(${target} PRIVATE ${sanitize} -g1)
    target_link_options(${target} PUBLIC ${sanitize})
  endif()
endfunction()
