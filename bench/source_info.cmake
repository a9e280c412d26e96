# Writes OUTPUT, a header that says what the tree SOURCE holds: the commit it is at, whether files differ from it, and a hash of
# the measured files' names and contents. Runs with every build and touches OUTPUT only if something changed. BUILD_INFO is the
# header with compilers, flags and options; its hash goes beside the other.
# A tree without .git (an archive, a copy) has commit "unknown", and the same hash; $TOUCHSTONE_SOURCE_COMMIT overrides the commit
# at run time.
cmake_policy(SET CMP0009 NEW)  # GLOB_RECURSE does not follow links to folders

# Results, plots and documents do not change what is measured.
set(measured bench cmake CMakeLists.txt datasets include kernels peers reference_cpu)

# Tracked or not, git or not: every file but editors' leavings.
set(lines "")
foreach(part IN LISTS measured)
  file(GLOB_RECURSE files RELATIVE ${SOURCE} ${SOURCE}/${part}/*)
  if(EXISTS ${SOURCE}/${part} AND NOT IS_DIRECTORY ${SOURCE}/${part})
    list(APPEND files ${part})
  endif()
  list(SORT files)
  foreach(file IN LISTS files)
    if(NOT file MATCHES "(^|/)\\.|~$|\\.(swp|orig|rej)$")
      file(SHA1 ${SOURCE}/${file} hash)
      string(APPEND lines "${hash} ${file}\n")
    endif()
  endforeach()
endforeach()
string(SHA1 content_hash "${lines}")
string(SUBSTRING ${content_hash} 0 16 content_hash)
file(SHA1 ${BUILD_INFO} build_hash)
string(SUBSTRING ${build_hash} 0 16 build_hash)

# A copy within somebody else's repository is none: there --show-cdup says the way up to its top.
execute_process(COMMAND git -C ${SOURCE} rev-parse --show-cdup OUTPUT_VARIABLE way_up OUTPUT_STRIP_TRAILING_WHITESPACE
                ERROR_QUIET RESULT_VARIABLE no_repository)
execute_process(COMMAND git -C ${SOURCE} rev-parse HEAD OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE
                ERROR_QUIET RESULT_VARIABLE no_commit)
set(dirty false)
if(no_repository OR no_commit OR NOT way_up STREQUAL "")
  set(commit unknown)
else()
  execute_process(COMMAND git --no-optional-locks -C ${SOURCE} status --porcelain --untracked-files=all -- ${measured} OUTPUT_VARIABLE changes ERROR_QUIET)
  if(NOT changes STREQUAL "")
    set(dirty true)
  endif()
endif()

file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#pragma once
namespace touchstone::source_info {
inline constexpr const char* kCommit = "@commit@";
inline constexpr bool kDirty = @dirty@;
inline constexpr const char* kContentHash = "@content_hash@";
inline constexpr const char* kBuildHash = "@build_hash@";
}  // namespace touchstone::source_info
]] @ONLY)
