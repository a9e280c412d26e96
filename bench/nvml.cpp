#include "bench/nvml.h"

#include <dlfcn.h>

#include <utility>

namespace touchstone {
namespace {

// Minimal declarations of NVML's C interface (stable across drivers); every call returns 0 on success.
using Device = void*;
struct ProcessInfo {  // nvmlProcessInfo_t, version 2 and 3
  unsigned pid;
  unsigned long long memory;
  unsigned gpu_instance, compute_instance;
};

class Library {
 public:
  Library() : handle_(dlopen("libnvidia-ml.so.1", RTLD_NOW | RTLD_LOCAL)) { ready_ = handle_ && call<>("nvmlInit_v2"); }
  ~Library() {
    if (ready_) call<>("nvmlShutdown");
    if (handle_) dlclose(handle_);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  bool ready() const { return ready_; }

  // Calls `name` with these very types; false if it is absent or fails.
  template <class... Args>
  bool call(const char* name, Args... args) const {
    auto* function = reinterpret_cast<int (*)(Args...)>(dlsym(handle_, name));
    return function && function(args...) == 0;
  }

  template <class T, class... Args>
  std::optional<T> ask(const char* name, Args... args) const {
    T value{};
    return call(name, args..., &value) ? std::optional<T>(value) : std::nullopt;
  }

 private:
  void* handle_;
  bool ready_ = false;
};

std::optional<bool> first_of_two(const Library& nvml, const char* name, Device device) {
  unsigned current = 0, pending = 0;
  if (!nvml.call(name, device, &current, &pending)) return std::nullopt;
  return current != 0;
}

std::optional<int> count_compute_processes(const Library& nvml, Device device) {
  ProcessInfo info[64];
  unsigned count = 64;
  if (!nvml.call("nvmlDeviceGetComputeRunningProcesses_v3", device, &count, &info[0])) return std::nullopt;
  return static_cast<int>(count);
}

template <class To, class From>
std::optional<To> scaled(const std::optional<From>& value, double factor = 1) {
  return value ? std::optional<To>(static_cast<To>(static_cast<double>(*value) * factor)) : std::nullopt;
}

}  // namespace

NvmlReading read_nvml(const std::string& pci_bus_id) {
  constexpr int kTemperatureGpu = 0, kClockSm = 1, kClockMemory = 2;
  NvmlReading r;
  const Library nvml;
  if (!nvml.ready()) return r;
  char driver[96] = "";
  if (nvml.call("nvmlSystemGetDriverVersion", &driver[0], 96u)) r.driver = driver;
  Device device = nullptr;
  if (!nvml.call("nvmlDeviceGetHandleByPciBusId_v2", pci_bus_id.c_str(), &device)) return r;
  r.compute_processes = count_compute_processes(nvml, device);
  r.ecc = first_of_two(nvml, "nvmlDeviceGetEccMode", device);
  r.mig = first_of_two(nvml, "nvmlDeviceGetMigMode", device);
  r.persistence = scaled<bool>(nvml.ask<unsigned>("nvmlDeviceGetPersistenceMode", device));
  r.display_active = scaled<bool>(nvml.ask<unsigned>("nvmlDeviceGetDisplayActive", device));
  r.compute_mode = scaled<int>(nvml.ask<unsigned>("nvmlDeviceGetComputeMode", device));
  r.temperature_c = scaled<double>(nvml.ask<unsigned>("nvmlDeviceGetTemperature", device, kTemperatureGpu));
  r.power_w = scaled<double>(nvml.ask<unsigned>("nvmlDeviceGetPowerUsage", device), 1e-3);
  r.power_limit_w = scaled<double>(nvml.ask<unsigned>("nvmlDeviceGetPowerManagementLimit", device), 1e-3);
  r.sm_mhz = scaled<int>(nvml.ask<unsigned>("nvmlDeviceGetClockInfo", device, kClockSm));
  r.memory_mhz = scaled<int>(nvml.ask<unsigned>("nvmlDeviceGetClockInfo", device, kClockMemory));
  r.max_sm_mhz = scaled<int>(nvml.ask<unsigned>("nvmlDeviceGetMaxClockInfo", device, kClockSm));
  r.max_memory_mhz = scaled<int>(nvml.ask<unsigned>("nvmlDeviceGetMaxClockInfo", device, kClockMemory));
  r.pcie_generation = scaled<int>(nvml.ask<unsigned>("nvmlDeviceGetCurrPcieLinkGeneration", device));
  r.pcie_width = scaled<int>(nvml.ask<unsigned>("nvmlDeviceGetCurrPcieLinkWidth", device));
  r.event_reasons = nvml.ask<unsigned long long>("nvmlDeviceGetCurrentClocksThrottleReasons", device);
  return r;
}

std::optional<unsigned long long> read_event_reasons(const std::string& pci_bus_id) {
  static const Library nvml;
  Device device = nullptr;
  if (!nvml.ready() || !nvml.call("nvmlDeviceGetHandleByPciBusId_v2", pci_bus_id.c_str(), &device)) return std::nullopt;
  return nvml.ask<unsigned long long>("nvmlDeviceGetCurrentClocksThrottleReasons", device);
}

constexpr unsigned long long kSoftwarePowerCap = 0x4;
constexpr std::pair<unsigned long long, const char*> kReasons[] = {{0x1, "idle"},
                                                                   {0x2, "applications_clocks_setting"},
                                                                   {kSoftwarePowerCap, "sw_power_cap"},
                                                                   {0x8, "hw_slowdown"},
                                                                   {0x10, "sync_boost"},
                                                                   {0x20, "sw_thermal_slowdown"},
                                                                   {0x40, "hw_thermal_slowdown"},
                                                                   {0x80, "hw_power_brake_slowdown"},
                                                                   {0x100, "display_clock_setting"}};

std::string event_reason_names(unsigned long long reasons) {
  std::string names;
  for (const auto& [bit, name] : kReasons)
    if (reasons & bit) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

bool is_throttled(unsigned long long reasons) { return (reasons & (0x8 | 0x20 | 0x40 | 0x80)) != 0; }

std::vector<std::string> event_flags(const std::optional<unsigned long long>& reasons) {
  if (!reasons) return {"throttle_unknown"};
  std::vector<std::string> flags;
  if (is_throttled(*reasons)) flags.push_back("throttled");
  if (*reasons & kSoftwarePowerCap) flags.push_back("sw_power_cap");
  return flags;
}

}  // namespace touchstone
