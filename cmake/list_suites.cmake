# Run when a program of gtests was linked: writes the file OUTPUT, by which ctest runs every suite of
# PROGRAM as a test PREFIX.SUITE, in a process of its own. A start takes longer than most single tests.
# Suites that COSTS lists start first, and in several processes of some SECONDS each. A process has
# TIMEOUT seconds: more where nothing is optimised, or a sanitizer looks on.
cmake_minimum_required(VERSION 3.16)
set(SECONDS 8)

execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_FILE ${OUTPUT}.list
  RESULT_VARIABLE result TIMEOUT 60)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests failed: ${result}")
endif()
file(STRINGS ${OUTPUT}.list lines REGEX "^[A-Za-z0-9_/]+\\.($|  #)")
file(REMOVE ${OUTPUT}.list)

# Where all tests of a suite were skipped, so is the suite; one that fails does so all the same.
string(CONCAT all_skipped "\\[  PASSED  \\] 0 tests\\.\n"
  "\\[  SKIPPED \\] [0-9]+ tests?, listed below:\n(\\[  SKIPPED \\] [^\n]*\n?)*$")

set(script)
function(add_suite name suite properties)
  string(APPEND script "add_test([==[${name}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${suite}.*]==])\n"
    "set_tests_properties([==[${name}]==] PROPERTIES TIMEOUT ${TIMEOUT} "
    "SKIP_REGULAR_EXPRESSION [==[${all_skipped}]==] ${properties})\n")
  set(script "${script}" PARENT_SCOPE)
endfunction()

foreach(line ${lines})
  string(REGEX REPLACE "\\..*" "" suite "${line}")
  file(STRINGS ${COSTS} cost REGEX "^${PREFIX}\\.${suite} [0-9]+$")
  string(REGEX REPLACE ".* " "" seconds "${cost}")
  if(NOT cost)
    add_suite(${PREFIX}.${suite} ${suite} "")
    continue()
  endif()
  execute_process(COMMAND ${PROGRAM} --gtest_list_tests --gtest_filter=${suite}.*
    OUTPUT_VARIABLE tests)
  string(REGEX MATCHALL "\n  [A-Za-z]" tests "${tests}")
  list(LENGTH tests count)
  math(EXPR most "(${seconds} + ${SECONDS} - 1) / ${SECONDS}")
  if(most LESS count)
    set(count ${most})
  endif()
  math(EXPR share "${seconds} / ${count}")
  math(EXPR last "${count} - 1")
  foreach(index RANGE ${last})
    set(name ${PREFIX}.${suite})
    if(count GREATER 1)
      math(EXPR number "${index} + 1")
      string(APPEND name "(${number}of${count})")
    endif()
    add_suite("${name}" ${suite}
      "COST ${share} ENVIRONMENT \"GTEST_TOTAL_SHARDS=${count};GTEST_SHARD_INDEX=${index}\"")
  endforeach()
endforeach()
file(WRITE ${OUTPUT} "${script}")
