# `import pliant` (docs/python.md): a module of pybind11 and the package around it, in the folder where
# catkin also puts Python's messages: both are the package `pliant`.

set(python_packages lib/python3/dist-packages)
set(missing)
find_package(pybind11 QUIET)
if(NOT pybind11_FOUND)
  set(missing "pybind11 and Python's headers were not found (Debian: pybind11-dev, python3-dev)")
elseif(NOT PYTHON_MODULE_EXTENSION)
  set(missing "pybind11 found no Python")
endif()
if(missing AND PLIANT_PYTHON STREQUAL "REQUIRED")
  message(FATAL_ERROR "PLIANT_PYTHON is REQUIRED, but ${missing}")
elseif(missing)
  message(WARNING "${missing}: there will be no `import pliant`; everything else works")
  return()
endif()

set(package_folder ${PROJECT_BINARY_DIR}/${python_packages}/pliant)
if(PLIANT_ROS)
  set(package_folder ${CATKIN_DEVEL_PREFIX}/${python_packages}/pliant)
endif()
file(GLOB python_sources CONFIGURE_DEPENDS python/bindings/*.cpp)
pybind11_add_module(pliant_python MODULE NO_EXTRAS ${python_sources})
target_link_libraries(pliant_python PRIVATE pliant_api)
# What takes time is the library.
target_compile_options(pliant_python PRIVATE $<$<CONFIG:Release>:-O1>)
set_target_properties(pliant_python PROPERTIES OUTPUT_NAME _pliant DEFINE_SYMBOL ""
  LIBRARY_OUTPUT_DIRECTORY ${package_folder})
file(RELATIVE_PATH libraries_from_package ${package_folder} ${PLIANT_LIBRARY_DIR})
# Of a wheel, of a prefix, of the build folder.
pliant_set_run_path(pliant_python $ORIGIN/lib $ORIGIN/../../.. $ORIGIN/${libraries_from_package})
add_dependencies(pliant_python ${PLIANT_LOADED})

file(GLOB_RECURSE package_files RELATIVE ${PROJECT_SOURCE_DIR}/python/pliant CONFIGURE_DEPENDS
  python/pliant/*.py python/pliant/*.pyi python/pliant/py.typed python/pliant/*.yaml
  python/pliant/*.urdf)
foreach(file ${package_files})
  configure_file(python/pliant/${file} ${package_folder}/${file} COPYONLY)
  get_filename_component(folder ${file} DIRECTORY)
  install(FILES python/pliant/${file} DESTINATION ${python_packages}/pliant/${folder}
    COMPONENT python)
endforeach()
install(TARGETS pliant_python LIBRARY DESTINATION ${python_packages}/pliant COMPONENT python)

if(PLIANT_TESTS)
  add_test(NAME python.pytest
    COMMAND ${PYTHON_EXECUTABLE} -B -m pytest -q -p no:cacheprovider ${PROJECT_SOURCE_DIR}/python/tests)
  add_test(NAME python.wheel COMMAND ${PROJECT_SOURCE_DIR}/tests/build/python_wheel
    ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR} ${PLIANT_LIBRARY_DIR})
  get_filename_component(packages ${package_folder} DIRECTORY)
  set_tests_properties(python.pytest PROPERTIES TIMEOUT 300
    ENVIRONMENT "PYTHONPATH=${packages};PLIANT_PROGRAM=$<TARGET_FILE:pliant_app>")
  set_tests_properties(python.wheel PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 300)
endif()
