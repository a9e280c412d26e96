#include "datasets/file_bytes.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "datasets/files.h"

namespace touchstone {

FileBytes::FileBytes(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status;
  if (file >= 0 && ::fstat(file, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0) {
    const std::size_t size = static_cast<std::size_t>(status.st_size);
    void* const at = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
    if (at != MAP_FAILED) {
      ::madvise(at, size, MADV_SEQUENTIAL);
      mapped_ = at;
      text_ = {static_cast<const char*>(at), size};
    }
  }
  if (file >= 0) ::close(file);
  if (mapped_) return;
  copy_ = read_whole(path);  // a pipe, an empty file, or one that cannot be read, which it says
  text_ = copy_;
}

FileBytes::~FileBytes() {
  if (mapped_) ::munmap(mapped_, text_.size());
}

}  // namespace touchstone
