#include "datasets/file_bytes.h"

#include <sys/mman.h>

#include "datasets/files.h"

namespace touchstone {

FileBytes::FileBytes(const std::filesystem::path& path) {
  const OpenFile file(path);
  if (file.size() > 0) {
    void* const at = ::mmap(nullptr, file.size(), PROT_READ, MAP_PRIVATE, file.descriptor(), 0);
    if (at != MAP_FAILED) {
      ::madvise(at, file.size(), MADV_SEQUENTIAL);
      mapped_ = at;
      text_ = {static_cast<const char*>(at), file.size()};
      return;
    }
  }
  copy_ = file.read();  // a pipe, an empty file, or one that cannot be mapped
  text_ = copy_;
}

FileBytes::~FileBytes() {
  if (mapped_) ::munmap(mapped_, text_.size());
}

}  // namespace touchstone
