#include "bench/machine.h"

#include <fmt/format.h>
#include <sys/personality.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cctype>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <thread>

#include "bench/detectors.h"
#include "bench/gpu_facts.h"
#include "build_info.h"
#include "source_info.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

std::string first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

// The value after "key" and a separator on the first line of `path` that starts with key; "" if none.
std::string value_of(const std::string& path, std::string_view key, char separator) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);)
    if (line.compare(0, key.size(), key) == 0) {
      const auto at = line.find(separator);
      if (at == std::string::npos) continue;
      auto begin = line.find_first_not_of(" \t\"", at + 1), end = line.find_last_not_of(" \t\"");
      return begin == std::string::npos ? "" : line.substr(begin, end - begin + 1);
    }
  return "";
}

std::string cpu_model() {
  const std::string model = value_of("/proc/cpuinfo", "model name", ':');
  return model.empty() ? "unknown" : model;
}

Json or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

double load_1min() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : -1;
}

// "1": on, "0": off, "": the kernel does not say. Intel's driver tells the opposite, no_turbo.
std::string boost() {
  if (const std::string on = first_line("/sys/devices/system/cpu/cpufreq/boost"); !on.empty()) return on;
  const std::string off = first_line("/sys/devices/system/cpu/intel_pstate/no_turbo");
  return off.empty() ? "" : off == "0" ? "1" : "0";
}

// Whether this process has its addresses randomised; null if the kernel does not say.
Json aslr() {
  const std::string mode = first_line("/proc/sys/kernel/randomize_va_space");
  if (mode.empty()) return nullptr;
  constexpr unsigned long kAskOnly = 0xffffffff;
  const int persona = personality(kAskOnly);
  return mode != "0" && !(persona >= 0 && (persona & ADDR_NO_RANDOMIZE));
}

// Among compiler flags as CMake joins them.
bool has_flag(const Json& flags, const std::string& flag) {
  return flags.is_string() && (" " + flags.get<std::string>() + " ").find(" " + flag + " ") != std::string::npos;
}

}  // namespace

std::string slug(std::string_view text) {
  std::string s;
  for (const char ch : text) {
    const auto c = static_cast<unsigned char>(ch);
    if (std::isalnum(c))
      s += static_cast<char>(std::tolower(c));
    else if (!s.empty() && s.back() != '-')
      s += '-';
  }
  while (!s.empty() && s.back() == '-') s.pop_back();
  return s;
}

std::string machine_slug() { return gpu_usable() ? slug(gpu_name()) : cpu_slug(cpu_model()); }

std::string cpu_slug(std::string model) {
  for (const std::string mark : {"(R)", "(TM)", "(r)", "(tm)"})
    for (auto at = model.find(mark); at != std::string::npos; at = model.find(mark)) model.replace(at, mark.size(), " ");
  return "cpu-" + slug(model);
}

Json source_json() {
  Json j;
  j["version"] = build_info::kVersion;
  j["commit"] = source_info::kCommit;
  j["dirty"] = source_info::kDirty;
  j["content_hash"] = source_info::kContentHash;
  if (const char* stated = std::getenv("TOUCHSTONE_SOURCE_COMMIT"); stated && *stated) {
    std::string commit = stated;
    const bool dirty = commit.ends_with("-dirty");
    if (dirty) commit.resize(commit.size() - 6);
    j["commit"] = commit;
    j["dirty"] = dirty;
    j["stated"] = true;  // by the environment, not read from a repository
  }
  return j;
}

std::string source_key() { return fmt::format("{}-{}", source_info::kContentHash, source_info::kBuildHash); }

Json build_json() {
  Json j;
  j["type"] = build_info::kType;
  j["compiler"] = build_info::kCompiler;
  j["flags"] = build_info::kFlags;
  j["sanitizer"] = or_null(build_info::kSanitize);
#if defined(NDEBUG)
  j["asserts"] = false;
#else
  j["asserts"] = true;
#endif
  j["cuda_compiler"] = or_null(build_info::kCudaCompiler);
  j["cuda_flags"] = or_null(build_info::kCudaFlags);
  j["cuda_architectures"] = or_null(build_info::kCudaArchitectures);
  return j;
}

Json host_json() {
  utsname name{};
  uname(&name);
  const std::string governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  const std::string flags = value_of("/proc/cpuinfo", "flags", ':');
  Json j;
  j["cpu"] = cpu_model();
  j["cores"] = std::thread::hardware_concurrency();
  j["memory_bytes"] = static_cast<std::int64_t>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
  j["kernel"] = std::string(name.release);
  j["distribution"] = or_null(value_of("/etc/os-release", "PRETTY_NAME", '='));
  j["governor"] = or_null(governor);
  j["virtual_machine"] = flags.find(" hypervisor") != std::string::npos;
  j["boost"] = or_null(boost());
  j["aslr"] = aslr();
  return j;
}

bool mps_offered() {
  const char* stated = std::getenv("CUDA_MPS_PIPE_DIRECTORY");
  const std::filesystem::path folder = stated && *stated ? stated : "/tmp/nvidia-mps";
  std::error_code unreachable;
  return std::filesystem::exists(folder / "control", unreachable);
}

Json state_json() {
  Json j;
  j["utc"] = utc_now();
  j["load_1min"] = load_1min();
  j["gpu"] = gpu_state_json();
  return j;
}

std::vector<std::string> refusals(const Json& build, const Json& device, int other_processes) {
  std::vector<std::string> reasons;
  if (build["type"] != "Release" && build["type"] != "RelWithDebInfo")
    reasons.push_back(fmt::format("build type '{}': times of an unoptimised build mean nothing (use Release)",
                                  build["type"].get<std::string>()));
  if (!build["sanitizer"].is_null()) reasons.push_back("sanitizer build");
  if (has_flag(build.value("cuda_flags", Json()), "-G") || has_flag(build.value("cuda_flags", Json()), "--device-debug"))
    reasons.push_back("device code built for the debugger (-G)");
  if (other_processes > 0) reasons.push_back(fmt::format("{} other compute process(es) on the GPU", other_processes));
  if (device.is_object() && device.value("mig", Json(nullptr)) == true)
    reasons.push_back("the GPU is in MIG mode: a slice, not a card");
  return reasons;
}

std::vector<std::string> forced_refusals(const Json& build, const Json& device, int other_processes, bool force) {
  std::vector<std::string> forced;
  for (const std::string& reason : refusals(build, device, other_processes)) {
    if (!force) throw InputError(reason + "; --force measures all the same, and the record says so");
    forced.push_back("forced: " + reason);
  }
  return forced;
}

std::vector<std::string> source_objections(const Json& source) {
  std::vector<std::string> objections;
  if (source["commit"] == "unknown") objections.push_back("source commit unknown");
  if (source["dirty"] == true) objections.push_back("uncommitted changes in the measured source");
  return objections;
}

std::string throttling_objection(std::size_t throttled_samples, std::size_t samples) {
  if (100 * throttled_samples <= samples) return "";
  return fmt::format("GPU throttled (heat, hardware slowdown or power brake) after cases with {} of {} samples",
                     throttled_samples, samples);
}

namespace {

// Flags `name` where the fact is true, `name`_unknown where nobody could say.
void flag_fact(std::vector<std::string>& flags, const Json& fact, const std::string& name) {
  if (fact.is_null())
    flags.push_back(name + "_unknown");
  else if (fact == true)
    flags.push_back(name);
}

void flag_device(std::vector<std::string>& flags, const Json& device, int other_processes) {
  if (other_processes < 0) flags.push_back("other_processes_unknown");
  // A card without MIG does not answer; nor does any where NVML, which names the driver, is absent.
  if (device.value("driver", Json()).is_null() && device.value("mig", Json()).is_null()) flags.push_back("mig_unknown");
  flag_fact(flags, device.value("mps", Json()), "mps");
  const Json persistence = device.value("persistence", Json());
  if (persistence != true) flags.push_back(persistence.is_null() ? "persistence_unknown" : "persistence_off");
  flag_fact(flags, device.value("display_active", Json()), "display_active");
  flags.push_back("clock_lock_unknown");  // NVML sets locked clocks, and has no question for them
}

}  // namespace

std::vector<std::string> run_flags(const Json& source, const Json& host, const Json& device, double load, int other_processes) {
  std::vector<std::string> flags;
  if (source["commit"] == "unknown") flags.push_back("commit_unknown");
  if (source["dirty"] == true) flags.push_back("dirty");
  if (host["virtual_machine"] == true) flags.push_back("virtual_machine");
  if (host["governor"].is_null())
    flags.push_back("governor_unknown");
  else if (host["governor"] != "performance")
    flags.push_back("governor_" + host["governor"].get<std::string>());
  const Json boost = host.value("boost", Json());
  flag_fact(flags, boost.is_null() ? Json() : Json(boost != "0"), "boost");
  flag_fact(flags, host.value("aslr", Json()), "aslr");
  if (load < 0) flags.push_back("load_unknown");
  if (load > 1) flags.push_back("load");
  if (device.is_object()) flag_device(flags, device, other_processes);
  return flags;
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm tm{};
  gmtime_r(&now, &tm);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &tm);
  return text;
}

}  // namespace touchstone
