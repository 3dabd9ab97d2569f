# Provides Eigen 3.4's headers as Eigen3::Eigen: the system's (Debian: libeigen3-dev), or else those
# of PyPI's cmeel-eigen, beside the Python package that holds this file or in the Python found.
find_package(Eigen3 3.4 CONFIG QUIET)

if(NOT TARGET Eigen3::Eigen)
  find_package(Python QUIET COMPONENTS Interpreter)
  set(ask "from importlib.metadata import distribution as installed"
          "print(installed('cmeel-eigen').locate_file('cmeel.prefix'), end='')")
  list(JOIN ask "\n" ask)
  execute_process(COMMAND ${Python_EXECUTABLE} -c ${ask} OUTPUT_VARIABLE prefix ERROR_QUIET)
  set(beside "${CMAKE_CURRENT_LIST_DIR}/../../../../cmeel.prefix")  # site-packages/cmeel.prefix
  find_package(Eigen3 3.4 CONFIG QUIET PATHS "${beside}" "${prefix}" NO_DEFAULT_PATH)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
  Eigen
  REQUIRED_VARS Eigen3_DIR
  VERSION_VAR Eigen3_VERSION
  REASON_FAILURE_MESSAGE
    "Eigen 3.4 is missing. Install Debian's libeigen3-dev, or with pip: 'cmeel-eigen>=3.4,<3.5'.")
