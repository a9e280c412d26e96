// Whole files, and nothing in between: a reader sees the old content or the new.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace touchstone {

// Writes beside `path`, or beside what it links to, flushes and renames; a pipe or device is written into. Throws InputError.
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

// A file open for reading: opened once, since what a pipe's writer sends goes to whoever had it open then.
class OpenFile {
 public:
  explicit OpenFile(const std::filesystem::path& path);  // Throws InputError: a folder, or a file that cannot be opened.
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int descriptor() const { return file_; }
  std::size_t size() const { return size_; }  // bytes of a regular file; 0 for anything else, which has none to tell
  std::string read() const;                   // all bytes up to the end. Throws InputError.

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::size_t size_ = 0;
};

// All bytes of a file or pipe. Throws InputError.
std::string read_whole(const std::filesystem::path& path);

// An exclusive lock, held as long as the object lives and by one process at a time; gone when the process ends, however it ends.
// The lock file stays.
class FileLock {
 public:
  // Tries ten times a second. `busy` is called after each try that found another process holding the lock: it throws to give up,
  // and returns to go on waiting. Throws InputError if the file cannot be opened or locked at all.
  FileLock(const std::filesystem::path& path, const std::function<void()>& busy);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace touchstone
