// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// A project file from outside: what can be loaded can be saved, and loads again as it was saved.

#include "io/project_store.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include <QCoreApplication>

namespace {

using namespace alidade;

/// SQLite wants a file with a name; it is gone with the process.
struct Workplace {
  std::string folder, given, saved;

  Workplace() {
    char name[] = "/tmp/alidade_project_fuzz_XXXXXX";
    if (!::mkdtemp(name)) std::abort();
    folder = name;
    given = folder + "/given.alidade";
    saved = folder + "/saved.alidade";
  }
  ~Workplace() {
    std::remove(given.c_str());
    std::remove(saved.c_str());
    ::rmdir(folder.c_str());
  }
};

void write(const std::string& path, const std::uint8_t* data, std::size_t size) {
  const int file = ::open(path.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
  if (file < 0 || ::write(file, data, size) != static_cast<ssize_t>(size)) std::abort();
  ::close(file);
}

bool sameSizes(const Project& a, const Project& b) {
  return a.scans.size() == b.scans.size() && a.designs.size() == b.designs.size() &&
         a.cameras.size() == b.cameras.size() && a.videos.size() == b.videos.size() &&
         a.frames.size() == b.frames.size() && a.stakePoints.size() == b.stakePoints.size() &&
         a.controlPoints.size() == b.controlPoints.size() && a.observations.size() == b.observations.size() &&
         a.annotations.size() == b.annotations.size() && a.findings.size() == b.findings.size();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static int argc = 1;
  static char program[] = "fuzz";
  static char* argv[] = {program, nullptr};
  static const QCoreApplication application(argc, argv);  // SQLite's driver is a Qt plugin
  static const Workplace workplace;

  write(workplace.given, data, size);
  const auto project = loadProject(workplace.given);
  if (!project) {
    if (project.error().what.empty()) std::abort();
    return 0;
  }
  if (const auto saved = saveProject(*project, workplace.saved); !saved) {
    std::fprintf(stderr, "What was loaded cannot be saved: %s\n", saved.error().text().c_str());
    std::abort();
  }
  const auto again = loadProject(workplace.saved);
  if (!again) {
    std::fprintf(stderr, "What was saved cannot be loaded: %s\n", again.error().text().c_str());
    std::abort();
  }
  if (!sameSizes(*project, *again)) std::abort();
  return 0;
}
