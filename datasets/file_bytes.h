// A large input file, seen without copying it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace touchstone {

// A whole file as bytes: mapped where it is a regular file, else read (a pipe). Throws InputError.
class FileBytes {
 public:
  explicit FileBytes(const std::filesystem::path& path);
  ~FileBytes();
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;
  std::string_view text() const { return text_; }

 private:
  void* mapped_ = nullptr;
  std::string copy_;
  std::string_view text_;
};

}  // namespace touchstone
