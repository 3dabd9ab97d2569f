# pendcore_compile_together(target): how the sources of the core are compiled. Those of a folder of
# cpp/src are one translation unit, which takes half the time; small folders join the one that they
# serve. What takes longest stays alone: steppers, lanes, kernels of the equations, and Eigen's
# templates. No two things in a unit may have one name; clang-tidy reads every source by itself.
set(pendcore_stays_alone
    "steppers|_lanes|lanes_|in_memory|implicit_runge|eigenvalues|tangent|by_series|jacobian"
    "equations_of_m")
list(JOIN pendcore_stays_alone "|" pendcore_stays_alone)

function(pendcore_compile_together target)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources EXCLUDE REGEX ${pendcore_stays_alone})
  foreach(source ${sources})
    string(REGEX REPLACE "^.*/cpp/src/([a-z]+)/.*$" "\\1" folder ${source})
    string(REPLACE analysis ensemble folder ${folder})
    string(REPLACE scene simulate folder ${folder})
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${PENDCORE_TOGETHER}
                                             UNITY_BUILD_MODE GROUP)
  # In kernels, GCC 12 looks back at 100 stores that may be the source of a load instead of 1,000:
  # they compile in four fifths of the time, and no call is slower by more than 2 % (28 November
  # 2026). Elsewhere nothing gains by it, and it warns of what is not so.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(
      ${target} PRIVATE $<$<CONFIG:Release>:--param=sccvn-max-alias-queries-per-access=100>)
  endif()
endfunction()
