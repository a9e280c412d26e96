# Writes OUTPUT, a header with the commit this tree is at, each time the build runs; touches it only if something changed.
# A tree without .git (an archive, a copy) gives "unknown"; $TOUCHSTONE_SOURCE_COMMIT overrides at run time.
execute_process(COMMAND git -C ${SOURCE} rev-parse HEAD OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE
                ERROR_QUIET RESULT_VARIABLE failed)
set(dirty false)
set(changes "")
if(failed)
  set(commit unknown)
else()
  # Results, plots and documents do not change what is measured.
  set(measured bench cmake CMakeLists.txt datasets include kernels reference_cpu)
  execute_process(COMMAND git -C ${SOURCE} diff HEAD -- ${measured} OUTPUT_VARIABLE diff ERROR_QUIET)
  execute_process(COMMAND git -C ${SOURCE} ls-files --others --exclude-standard -- ${measured} OUTPUT_VARIABLE new ERROR_QUIET)
  if(NOT "${diff}${new}" STREQUAL "")
    set(dirty true)
    string(SHA1 changes "${diff}${new}")
    string(SUBSTRING ${changes} 0 12 changes)
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#pragma once
namespace touchstone::source_info {
inline constexpr const char* kCommit = "@commit@";
inline constexpr bool kDirty = @dirty@;
inline constexpr const char* kChanges = "@changes@";  // hash of the uncommitted changes, "" if none
}  // namespace touchstone::source_info
]] @ONLY)
