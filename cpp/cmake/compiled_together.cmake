# pendcore_compile_together(target): sources of the core that include the same are one translation
# unit, which takes half the time; kernels and what takes longest stay alone. No two things in a
# group may have one name; clang-tidy reads every source by itself.
set(together_scene
    dynamics/energetics/energy dynamics/energetics/ledger dynamics/energetics/reactions
    effects/driven_pivot effects/motor effects/registry effects/wave scene/scene)
set(together_run
    integrate/loop/first_step integrate/loop/stiffness integrate/methods integrate/stiff_switching
    integrate/taylor/dominant_eigenvalue simulate/ending_message simulate/initial_state
    simulate/method_choice simulate/not_finite simulate/options simulate/recorder simulate/simulate
    simulate/solution)
set(together_joints
    dynamics/contact/complementarity dynamics/contact/held_joints dynamics/joint_forces
    simulate/switching simulate/switching_guards)
set(together_events integrate/events/event integrate/events/root simulate/event_finder)

function(pendcore_compile_together target)
  foreach(group scene run joints events)
    list(TRANSFORM together_${group} PREPEND ${PROJECT_SOURCE_DIR}/cpp/src/ OUTPUT_VARIABLE sources)
    list(TRANSFORM sources APPEND .cpp)
    set_source_files_properties(${sources} PROPERTIES UNITY_GROUP ${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${PENDCORE_TOGETHER}
                                             UNITY_BUILD_MODE GROUP)
endfunction()
