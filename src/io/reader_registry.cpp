// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/reader_registry.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>

#include <QJsonObject>
#include <QPluginLoader>
#include <QString>

#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"
#include "io/known_formats.h"
#include "plugin_api/reader_plugin.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kHeadBytes = 4096;

/// Works without a QCoreApplication, too.
fs::path programFolder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path() : program.parent_path();
}

std::vector<std::string> pluginFolders() {
  std::vector<std::string> folders;
  if (const char* wanted = std::getenv("ALIDADE_PLUGIN_PATH")) {
    std::string_view rest(wanted);
    while (!rest.empty()) {
      const auto end = std::min(rest.find(':'), rest.size());
      if (end > 0) folders.emplace_back(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  if (const fs::path program = programFolder(); !program.empty())
    folders.push_back((program.parent_path() / "lib/alidade/plugins").string());
  folders.emplace_back(ALIDADE_INSTALLED_PLUGIN_DIR);
  return folders;
}

std::string_view kindWords(ReaderKind kind) {
  switch (kind) {
    case ReaderKind::Scan: return "a scan";
    case ReaderKind::Design: return "a design";
    case ReaderKind::Cameras: return "cameras or poses";
    case ReaderKind::Pictures: return "pictures or a video";
    case ReaderKind::Points: return "a list of points";
  }
  return "data";
}

/// "LAS point cloud (las, laz), PLY point cloud (ply)"
std::string formatList(const std::vector<std::unique_ptr<Reader>>& readers, std::optional<ReaderKind> kind) {
  std::string list;
  for (const auto& reader : readers) {
    if (kind && reader->kind() != *kind) continue;
    const ReaderDescription description = reader->description();
    list += (list.empty() ? "" : ", ") + description.name;
    for (std::size_t i = 0; i < description.extensions.size(); ++i)
      list += (i == 0 ? " (" : ", ") + description.extensions[i];
    if (!description.extensions.empty()) list += ")";
  }
  return list;
}

std::string extensionOf(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  if (extension.starts_with('.')) extension.erase(0, 1);
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

struct Claim {
  const Reader* reader = nullptr;
  int score = 0;
};

Claim bestClaim(const std::vector<std::unique_ptr<Reader>>& readers, const FileProbe& probe,
                std::optional<ReaderKind> kind) {
  Claim best;
  for (const auto& reader : readers) {
    if (kind && reader->kind() != *kind) continue;
    if (const int score = reader->sniff(probe); score > best.score) best = {reader.get(), score};
  }
  return best;
}

tl::unexpected<Error> refuseEmpty(const FileProbe& probe) {
  if (probe.isFolder) return fail("The folder is empty", probe.path, "Choose the folder that holds the files");
  return fail("The file is empty", probe.path, "Copy or export it again");
}

tl::unexpected<Error> refuseWithoutPlugins(const std::string& path) {
  return fail("No reader plugin is installed, so no file can be read", path,
              "Install Alidade whole, or set ALIDADE_PLUGIN_PATH to the plugins' folder");
}

bool isEmpty(const FileProbe& probe) {
  std::error_code error;
  return probe.isFolder ? fs::is_empty(probe.path, error) : probe.head.empty();
}

}  // namespace

ReaderRegistry::~ReaderRegistry() = default;

const ReaderRegistry& ReaderRegistry::instance() {
  // Never destroyed: readers live in libraries that Qt may unload before static objects go.
  static const ReaderRegistry* const registry = [] {
    auto* loaded = new ReaderRegistry;
    for (const std::string& folder : pluginFolders()) loaded->loadFolder(folder);
    for (const Error& error : loaded->m_loadErrors) logWarning(error.text());
    return loaded;
  }();
  return *registry;
}

void ReaderRegistry::loadFolder(const std::string& folder) {
  std::error_code error;
  std::set<fs::path> libraries;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".so") libraries.insert(fs::absolute(it->path()));

  for (const fs::path& library : libraries) {
    QPluginLoader loader(QString::fromStdString(library.string()));
    loader.setLoadHints(QLibrary::PreventUnloadHint);
    const std::string iid = loader.metaData().value("IID").toString().toStdString();
    if (iid != ALIDADE_READER_PLUGIN_IID) {
      m_loadErrors.push_back({iid.empty() ? std::string("The library is no Alidade plugin")
                                          : "The plugin speaks " + quotedWords(iid) + ", not " ALIDADE_READER_PLUGIN_IID,
                              library.string(), "Install the plugin that belongs to this version"});
      continue;
    }
    auto* plugin = qobject_cast<ReaderPlugin*>(loader.instance());
    if (!plugin) {
      m_loadErrors.push_back({"The plugin cannot be loaded: " + loader.errorString().toStdString(), library.string(),
                              "Install the libraries it needs"});
      continue;
    }
    for (auto& reader : plugin->readers()) add(std::move(reader));
    for (auto& writer : plugin->writers()) add(std::move(writer));
  }
}

void ReaderRegistry::add(std::unique_ptr<Reader> reader) {
  const std::string id = reader->description().id;
  const bool known = std::any_of(m_readers.begin(), m_readers.end(),
                                 [&](const auto& other) { return other->description().id == id; });
  if (!known) m_readers.push_back(std::move(reader));
}

void ReaderRegistry::add(std::unique_ptr<ScanWriter> writer) {
  const std::string id = writer->description().id;
  const bool known = std::any_of(m_writers.begin(), m_writers.end(),
                                 [&](const auto& other) { return other->description().id == id; });
  if (!known) m_writers.push_back(std::move(writer));
}

Result<const ScanWriter*> ReaderRegistry::findWriter(const std::string& path) const {
  std::string formats;
  for (const auto& writer : m_writers) {
    if (writer->writes(path)) return writer.get();
    formats += (formats.empty() ? "" : ", ") + writer->description().name;
  }
  if (formats.empty()) return fail("No plugin that writes scans is installed", path, "Install Alidade whole");
  return fail("No format that is written goes by this name", path, "Formats written: " + formats);
}

Result<const Reader*> ReaderRegistry::find(const std::string& path) const {
  std::vector<std::byte> head;
  const auto probe = probeFile(path, head);
  if (!probe) return fail(probe.error());
  if (isEmpty(*probe)) return refuseEmpty(*probe);
  if (m_readers.empty()) return refuseWithoutPlugins(path);
  if (const Claim best = bestClaim(m_readers, *probe, std::nullopt); best.reader) return best.reader;
  if (auto known = refusalOfKnownFormat(*probe)) return fail(std::move(*known));
  return fail(probe->isFolder ? "Nothing in the folder is of a kind that is read" : "No reader knows the file's format",
              path, "Formats read: " + formatList(m_readers, std::nullopt));
}

Result<const Reader*> ReaderRegistry::findKind(const std::string& path, ReaderKind kind) const {
  std::vector<std::byte> head;
  const auto probe = probeFile(path, head);
  if (!probe) return fail(probe.error());
  if (isEmpty(*probe)) return refuseEmpty(*probe);
  if (m_readers.empty()) return refuseWithoutPlugins(path);
  if (const Claim best = bestClaim(m_readers, *probe, kind); best.reader) return best.reader;

  const std::string formats = formatList(m_readers, kind);
  const std::string advice = formats.empty() ? "No plugin that reads " + std::string(kindWords(kind)) + " is installed"
                                             : "Formats read as " + std::string(kindWords(kind)) + ": " + formats;
  if (const Claim other = bestClaim(m_readers, *probe, std::nullopt); other.reader)
    return fail("This is " + std::string(kindWords(other.reader->kind())) + " (" + other.reader->description().name +
                    "), not " + std::string(kindWords(kind)), path, advice);
  if (auto known = refusalOfKnownFormat(*probe)) return fail(std::move(*known));
  return fail(probe->isFolder ? "Nothing in the folder can be read as " + std::string(kindWords(kind))
                              : "No reader of " + std::string(kindWords(kind)) + " knows the file's format",
              path, advice);
}

Result<FileProbe> probeFile(const std::string& path, std::vector<std::byte>& headStorage) {
  if (path.empty()) return fail("No file is named", {}, "Give a file or a folder");
  if (path.starts_with("http://") || path.starts_with("https://")) {
    // The reader that its ending names asks the server.
    FileProbe probe;
    probe.path = path;
    probe.extension = extensionOf(path);
    headStorage.assign(1, std::byte{0});
    probe.head = headStorage;
    return probe;
  }
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    if (errno == ENOENT || errno == ENOTDIR) return fail("The file does not exist", path, "Check the path");
    return fail(std::string("The file cannot be reached: ") + std::strerror(errno), path, "Check its permissions");
  }
  FileProbe probe;
  probe.path = path;
  headStorage.clear();
  if (S_ISDIR(status.st_mode)) {
    std::error_code error;
    fs::directory_iterator opened(path, error);
    if (error) return fail("The folder cannot be read: " + error.message(), path, "Check its permissions");
    probe.isFolder = true;
    return probe;
  }
  if (!S_ISREG(status.st_mode)) return fail("This is no ordinary file", path, "Choose a file or a folder");

  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) return fail(std::string("The file cannot be opened: ") + std::strerror(errno), path, "Check its permissions");
  headStorage.resize(kHeadBytes);
  const std::size_t count = std::fread(headStorage.data(), 1, headStorage.size(), file);
  const bool failed = std::ferror(file) != 0;
  std::fclose(file);
  if (failed) return fail("The file cannot be read", path, "Check the disk");
  headStorage.resize(count);
  probe.head = headStorage;
  probe.extension = extensionOf(path);
  return probe;
}

}  // namespace alidade
