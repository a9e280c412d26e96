// NVML, the driver's own library, found at run time: it is absent on machines without a GPU, and its header is often absent too.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace touchstone {

// Every member is empty where the library, or this question, is not answered.
struct NvmlReading {
  std::optional<std::string> driver;
  std::optional<int> compute_processes;
  std::optional<bool> ecc, mig, persistence, display_active;
  std::optional<int> compute_mode;
  std::optional<double> temperature_c, power_w, power_limit_w;
  std::optional<int> sm_mhz, memory_mhz, max_sm_mhz, max_memory_mhz, pcie_generation, pcie_width;
  std::optional<unsigned long long> event_reasons;  // bits of nvmlClocksEventReasons
};

// pci_bus_id as cudaDeviceGetPCIBusId writes it.
NvmlReading read_nvml(const std::string& pci_bus_id);

// The event reasons alone, from a library that stays open: cheap enough to ask after each case. Never within a timed region.
std::optional<unsigned long long> read_event_reasons(const std::string& pci_bus_id);

// "sw_power_cap, hw_thermal_slowdown"; "" for none.
std::string event_reason_names(unsigned long long reasons);

// Reasons that make a time unfit to report: hardware slowdown, thermal slowdown, power brake.
bool is_throttled(unsigned long long reasons);

// What a case is flagged with for the reasons read after its samples: "throttled", "sw_power_cap"; "throttle_unknown" where they
// cannot be read.
std::vector<std::string> event_flags(const std::optional<unsigned long long>& reasons);

}  // namespace touchstone
