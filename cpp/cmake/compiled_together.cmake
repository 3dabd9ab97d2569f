# pendcore_compile_together(target): the sources of a folder of cpp/src are one translation unit,
# which takes half the time; small folders join the one that they serve. What takes longest stays
# alone: steppers, lanes, kernels of the equations, and Eigen's templates. No two things in a unit
# may have one name; clang-tidy reads every source by itself.
function(pendcore_compile_together target)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources EXCLUDE REGEX
       "steppers|_lanes|lanes_|in_memory|eigenvalues|tangent|jacobian|equations_of_motion")
  foreach(source ${sources})
    string(REGEX REPLACE "^.*/cpp/src/([a-z]+)/.*$" "\\1" folder ${source})
    string(REPLACE analysis dynamics folder ${folder})
    string(REPLACE scene simulate folder ${folder})
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${PENDCORE_TOGETHER}
                                             UNITY_BUILD_MODE GROUP)
endfunction()
