# find_package(OpenMMHelfrich) for C and C++ programs:
#
#     cmake -DOpenMMHelfrich_DIR=$(python -c "import openmmhelfrich; print(openmmhelfrich.cmake_path())") …
#
#     find_package(OpenMMHelfrich REQUIRED)
#     target_link_libraries(program OpenMMHelfrich::OpenMMHelfrich)
#
# The target brings OpenMM along: the one in OPENMM_DIR (a folder with include and lib), a variable of
# CMake or of the environment, if that is set, else the one beside which the plugin was installed. Programs find both
# libraries where they are now.

get_filename_component(_helfrich_package "${CMAKE_CURRENT_LIST_DIR}/.." ABSOLUTE)
if(DEFINED OPENMM_DIR)
    set(_helfrich_openmm "${OPENMM_DIR}")
elseif(DEFINED ENV{OPENMM_DIR})
    set(_helfrich_openmm "$ENV{OPENMM_DIR}")
else()
    get_filename_component(_helfrich_openmm "${_helfrich_package}/../OpenMM.libs" ABSOLUTE)
endif()

find_path(OpenMMHelfrich_OPENMM_INCLUDE OpenMM.h PATHS "${_helfrich_openmm}/include" NO_DEFAULT_PATH)
find_library(OpenMMHelfrich_OPENMM_LIBRARY OpenMM PATHS "${_helfrich_openmm}/lib" NO_DEFAULT_PATH)
set(_helfrich_library "${_helfrich_package}/lib/libOpenMMHelfrich.so")

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
    OpenMMHelfrich
    REQUIRED_VARS _helfrich_library OpenMMHelfrich_OPENMM_INCLUDE OpenMMHelfrich_OPENMM_LIBRARY
    REASON_FAILURE_MESSAGE "OpenMM was not found in ${_helfrich_openmm}. Give -DOPENMM_DIR=…, a folder with include and lib.")

if(OpenMMHelfrich_FOUND AND NOT TARGET OpenMMHelfrich::OpenMMHelfrich)
    add_library(OpenMMHelfrich::OpenMMHelfrich SHARED IMPORTED)
    set_target_properties(OpenMMHelfrich::OpenMMHelfrich PROPERTIES
        IMPORTED_LOCATION "${_helfrich_library}"
        INTERFACE_INCLUDE_DIRECTORIES "${_helfrich_package}/include;${OpenMMHelfrich_OPENMM_INCLUDE}"
        INTERFACE_LINK_LIBRARIES "${OpenMMHelfrich_OPENMM_LIBRARY}"
        INTERFACE_COMPILE_FEATURES cxx_std_17)
endif()
