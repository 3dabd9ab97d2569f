# pendcore_compile_together(target): sources of the core that include the same are one translation
# unit, which takes half the time; kernels and what takes longest stay alone. No two things in a
# group may have one name; clang-tidy reads every source by itself.
set(together_scene driven_pivot energy ledger motor reactions registry scene wave)
set(together_run dominant_eigenvalue ending_message first_step method_choice method_pair methods
    not_finite options recorder simulate solution start stiffness)
set(together_joints complementarity held_joints joint_forces switching switching_guards)
set(together_events event event_finder root)

function(pendcore_compile_together target)
  foreach(group scene run joints events)
    list(TRANSFORM together_${group} PREPEND ${PROJECT_SOURCE_DIR}/cpp/src/ OUTPUT_VARIABLE sources)
    list(TRANSFORM sources APPEND .cpp)
    set_source_files_properties(${sources} PROPERTIES UNITY_GROUP ${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${PENDCORE_TOGETHER}
                                             UNITY_BUILD_MODE GROUP)
endfunction()
