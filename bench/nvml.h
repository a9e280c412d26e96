// NVML, the driver's own library, found at run time: it is absent on machines without a GPU, and its header is often absent too.
#pragma once

#include <optional>
#include <string>

namespace touchstone {

// Every member is empty where the library, or this question, is not answered.
struct NvmlReading {
  std::optional<std::string> driver;
  std::optional<int> compute_processes;
  std::optional<bool> ecc, mig, persistence;
  std::optional<int> compute_mode;
  std::optional<double> temperature_c, power_w, power_limit_w;
  std::optional<int> sm_mhz, memory_mhz, max_sm_mhz, max_memory_mhz, pcie_generation, pcie_width;
  std::optional<unsigned long long> event_reasons;  // bits of nvmlClocksEventReasons
};

// pci_bus_id as cudaDeviceGetPCIBusId writes it.
NvmlReading read_nvml(const std::string& pci_bus_id);

// "sw_power_cap, hw_thermal_slowdown"; "" for none.
std::string event_reason_names(unsigned long long reasons);

// Reasons that make a time unfit to report: hardware slowdown, thermal slowdown, power brake.
bool is_throttled(unsigned long long reasons);

}  // namespace touchstone
