# find_in_wheel(VARIABLE distribution path): the place of this path of a wheel in the active Python,
# as pip has installed it; empty if the wheel is missing. Headers and libraries come with wheels.
find_package(Python QUIET COMPONENTS Interpreter)

function(find_in_wheel variable distribution path)
  set(ask "from importlib.metadata import distribution as installed"
          "found = installed('${distribution}').locate_file('${path}')"
          "print(found if found.exists() else '', end='')")
  list(JOIN ask "\n" ask)
  execute_process(COMMAND ${Python_EXECUTABLE} -c ${ask} OUTPUT_VARIABLE found ERROR_QUIET)
  set(${variable} "${found}" PARENT_SCOPE)
endfunction()
