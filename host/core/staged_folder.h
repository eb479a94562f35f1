// A folder that is made under another name beside its place, and whole once it has its own.
#pragma once
#include <filesystem>
#include <string>

namespace rosefusion {

/// It is made as FOLDER.part and renamed at the end, so that a folder that is there is whole; what is left of
/// a process that was killed is taken away by the next. Unless it has taken its place, its destructor removes
/// it.
class StagedFolder {
 public:
  /// Throws InputError when `folder` exists and is not empty, or is no folder. `replaceable`: what holds a
  /// file of this name may be replaced all the same; empty: nothing may. To be called before any long work.
  /// `remedy`: what may be done about one that is not empty.
  static void requireUsable(const std::filesystem::path& folder, const std::string& replaceable,
                            const std::string& remedy = "give another folder");

  /// Throws as requireUsable().
  StagedFolder(const std::filesystem::path& folder, const std::string& replaceable);
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  /// Where its files are to be written.
  const std::filesystem::path& part() const { return part_; }
  /// What is in it is of worth even if it never takes its place: it then stays under the other name.
  void keep() { is_kept_ = true; }
  /// All is written: it gets its name. Throws InputError, and leaves it under the other name.
  void takePlace();

 private:
  std::filesystem::path folder_, part_;
  bool is_kept_ = false;
};

}  // namespace rosefusion
