#include "bench/gpu_facts.h"

#include <algorithm>

#include "bench/calibration.h"
#include "bench/detectors.h"
#include "bench/machine.h"
#include "bench/nvml.h"
#include "kernels/device.h"
#include "touchstone/contact.h"

namespace touchstone {

#if !defined(TOUCHSTONE_HAVE_CUDA)

std::string gpu_name() { return ""; }
Json gpu_state_json() { return nullptr; }
std::optional<unsigned long long> gpu_event_reasons() { return std::nullopt; }
Json device_json() { return nullptr; }
Json calibration_json() { return nullptr; }
int other_compute_processes() { return -1; }

#else

namespace {

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

// Of the device that is measured, which CUDA_VISIBLE_DEVICES and CUDA_DEVICE_ORDER choose: NVML numbers cards in its own way.
std::string pci_bus_id() {
  char id[32] = "";
  int device = 0;
  check(cudaGetDevice(&device));
  check(cudaDeviceGetPCIBusId(id, sizeof id, device));
  return id;
}

// A card's serial number is nobody's business; its hash still tells two cards apart.
std::string uuid_hash(const cudaUUID_t& uuid) {
  std::uint64_t half[2];
  static_assert(sizeof half == sizeof uuid.bytes);
  std::memcpy(half, uuid.bytes, sizeof half);
  return hex64(splitmix64(half[0] ^ splitmix64(half[1])));
}

int attribute(cudaDeviceAttr which, int device) {
  int value = 0;
  check(cudaDeviceGetAttribute(&value, which, device));
  return value;
}

}  // namespace

std::string gpu_name() {
  if (!gpu_usable()) return "";
  cudaDeviceProp p{};
  check(cudaGetDeviceProperties(&p, 0));
  return p.name;
}

// Asking for the bus makes no context, so our own process is not yet among those that are counted.
int other_compute_processes() { return gpu_usable() ? read_nvml(pci_bus_id()).compute_processes.value_or(-1) : -1; }

std::optional<unsigned long long> gpu_event_reasons() {
  static const std::string bus = gpu_usable() ? pci_bus_id() : "";
  return bus.empty() ? std::nullopt : read_event_reasons(bus);
}

Json gpu_state_json() {
  if (!gpu_usable()) return nullptr;
  const NvmlReading r = read_nvml(pci_bus_id());
  Json j;
  j["temperature_c"] = or_null(r.temperature_c);
  j["sm_mhz"] = or_null(r.sm_mhz);
  j["memory_mhz"] = or_null(r.memory_mhz);
  j["power_w"] = or_null(r.power_w);
  j["event_reasons"] = r.event_reasons ? Json(event_reason_names(*r.event_reasons)) : Json(nullptr);
  j["throttled"] = r.event_reasons ? Json(is_throttled(*r.event_reasons)) : Json(nullptr);
  return j;
}

Json device_json() {
  if (!gpu_usable()) return nullptr;
  int device = 0, runtime = 0, driver_api = 0;
  check(cudaGetDevice(&device));
  check(cudaRuntimeGetVersion(&runtime));
  check(cudaDriverGetVersion(&driver_api));
  cudaDeviceProp p{};
  check(cudaGetDeviceProperties(&p, device));
  const NvmlReading r = read_nvml(pci_bus_id());
  // Two transfers a clock (DDR); kHz and bits to GB/s.
  const double theoretical = 2.0 * attribute(cudaDevAttrMemoryClockRate, device) * 1e3 * (p.memoryBusWidth / 8.0) / 1e9;
  Json j;
  j["name"] = p.name;
  j["uuid_hash"] = uuid_hash(p.uuid);
  j["compute_capability"] = std::to_string(p.major) + "." + std::to_string(p.minor);
  j["sms"] = p.multiProcessorCount;
  j["memory_bytes"] = p.totalGlobalMem;
  j["l2_bytes"] = p.l2CacheSize;
  j["memory_bus_bits"] = p.memoryBusWidth;
  j["theoretical_gb_per_s"] = theoretical;
  j["driver"] = or_null(r.driver);
  j["driver_api"] = driver_api;
  j["runtime"] = runtime;
  j["ecc"] = r.ecc ? Json(*r.ecc) : Json(p.ECCEnabled != 0);
  j["mig"] = or_null(r.mig);
  j["mps"] = mps_offered();
  j["persistence"] = or_null(r.persistence);
  j["display_active"] = or_null(r.display_active);
  j["compute_mode"] = or_null(r.compute_mode);
  j["power_limit_w"] = or_null(r.power_limit_w);
  j["max_sm_mhz"] = or_null(r.max_sm_mhz);
  j["max_memory_mhz"] = or_null(r.max_memory_mhz);
  j["pcie_generation"] = or_null(r.pcie_generation);
  j["pcie_width"] = or_null(r.pcie_width);
  return j;
}

Json calibration_json() {
  if (!gpu_usable()) return nullptr;
  const Calibration c = calibrate();
  Json j;
  j["copy_gb_per_s"] = c.copy_gb_per_s;
  j["empty_launch_us"] = c.empty_launch_us;
  j["event_pair_us"] = c.event_pair_us;
  j["event_resolution_ns"] = c.event_resolution_ns;
  return j;
}

#endif

}  // namespace touchstone
