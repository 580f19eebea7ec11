// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/project_store.h"

#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>

#include "io/atomic_file.h"
#include "io/project_database.h"
#include "io/project_fields.h"
#include "io/project_paths.h"
#include "io/project_rows.h"
#include "io/project_schema.h"
#include "io/reader_registry.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

/// The statements of the schema, comments dropped; no text in it holds a semicolon.
std::vector<std::string> schemaStatements() {
  std::vector<std::string> statements(1);
  bool comment = false;
  for (std::size_t i = 0; i < kProjectSchema.size(); ++i) {
    const char c = kProjectSchema[i];
    if (kProjectSchema.substr(i).starts_with("--")) comment = true;
    if (c == '\n') comment = false;
    if (comment) continue;
    if (c == ';') statements.emplace_back();
    else statements.back() += c;
  }
  std::erase_if(statements, [](const std::string& s) { return s.find_first_not_of(" \n\r\t") == std::string::npos; });
  return statements;
}

template <class T>
std::vector<const char*> columnsOf() {
  RowWriter row;
  T blank{};
  visit(row, blank);
  return row.columns();
}

/// As SQL lists them; NULL stands for those that are `absent`.
std::string columnList(const std::vector<const char*>& columns, const std::vector<bool>& absent) {
  std::string list;
  for (std::size_t i = 0; i < columns.size(); ++i)
    list += (i == 0 ? "" : ", ") + std::string(absent[i] ? "NULL" : columns[i]);
  return list;
}

template <class T>
Result<void> writeRows(const ProjectDatabase& database, const std::string& table, const std::vector<T>& rows) {
  if (rows.empty()) return {};
  const auto columns = columnsOf<T>();
  std::string marks = "?";
  for (std::size_t i = 1; i < columns.size(); ++i) marks += ", ?";
  QSqlQuery query = database.query();
  const std::string statement = "INSERT INTO " + table + " (" +
                                columnList(columns, std::vector<bool>(columns.size())) + ") VALUES (" + marks + ")";
  if (!query.prepare(QString::fromStdString(statement)))
    return fail(database.error(query, "The project's " + table + " table cannot be written"));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    T item = rows[i];
    RowWriter row;
    visit(row, item);
    if (!row.problem().empty())
      return fail("The project cannot be saved: " + table + " " + std::to_string(i + 1) + ": " + row.problem(), {},
                  "Remove it from the project or mend it");
    for (std::size_t k = 0; k < row.values().size(); ++k) query.bindValue(static_cast<int>(k), row.values()[k]);
    if (!query.exec()) return fail(database.error(query, "The project's " + table + " table cannot be written"));
  }
  return {};
}

/// Which of the columns a file of an older version does not have yet. A file of this version has all.
std::vector<bool> absentColumns(const ProjectDatabase& database, const std::string& table,
                                const std::vector<const char*>& columns) {
  std::vector<bool> absent(columns.size(), false);
  QSqlQuery version = database.query();
  if (!version.exec("PRAGMA user_version") || !version.next() || version.value(0).toUInt() >= kProjectVersion) return absent;
  std::set<std::string> present;
  QSqlQuery info = database.query();
  info.exec(QString::fromStdString("PRAGMA main.table_xinfo(" + table + ")"));
  while (info.next()) present.insert(info.value("name").toString().toStdString());
  for (std::size_t i = 0; i < columns.size(); ++i) absent[i] = !present.contains(columns[i]);
  return absent;
}

template <class T>
Result<std::vector<T>> readRows(const ProjectDatabase& database, const std::string& path, const std::string& table,
                                bool ordered = true) {
  QSqlQuery query = database.query();
  const auto columns = columnsOf<T>();
  const std::vector<bool> absent = absentColumns(database, table, columns);
  const std::string statement = "SELECT " + columnList(columns, absent) + " FROM main." + table + (ordered ? " ORDER BY position" : "");
  if (!query.exec(QString::fromStdString(statement)))
    return fail(database.error(query, "The project's " + table + " table cannot be read"));
  std::vector<T> rows;
  while (query.next()) {
    T item{};
    RowReader row(query, absent);
    visit(row, item);
    if (!row.problem().empty())
      return fail("The project file is damaged: " + row.problem(), path + ", " + table + " " + std::to_string(rows.size() + 1),
                  "Open a backup of the project");
    rows.push_back(std::move(item));
  }
  if (query.lastError().isValid()) return fail(database.error(query, "The project's " + table + " table cannot be read"));
  return rows;
}

Result<void> writePointStyle(const ProjectDatabase& database, const PointStyle& style) {
  std::vector<PointCutRow> cuts;
  for (const CutPlane& cut : style.cuts) cuts.push_back({cut});
  return writeRows(database, "point_style", std::vector<PointStyle>{style}).and_then([&] { return writeRows(database, "point_cut", cuts); });
}

Result<void> writeScans(const ProjectDatabase& database, const Project& project) {
  std::vector<ScanAttributeRow> attributes;
  std::vector<ScanStationRow> stations;
  for (std::size_t i = 0; i < project.scans.size(); ++i) {
    for (const auto& name : project.scans[i].info.attributes) attributes.push_back({std::int64_t(i), name});
    for (const auto& station : project.scans[i].info.stations) stations.push_back({std::int64_t(i), station});
  }
  return writeRows(database, "scan", project.scans)
      .and_then([&] { return writeRows(database, "scan_attribute", attributes); })
      .and_then([&] { return writeRows(database, "scan_station", stations); });
}

Result<void> writeDesigns(const ProjectDatabase& database, const Project& project) {
  std::vector<HiddenElementRow> hidden;
  for (std::size_t i = 0; i < project.designs.size(); ++i)
    for (const auto& element : project.designs[i].hiddenElements) hidden.push_back({std::int64_t(i), element});
  return writeRows(database, "design", project.designs).and_then([&] {
    return writeRows(database, "design_hidden_element", hidden);
  });
}

Result<void> writeCameras(const ProjectDatabase& database, const Project& project) {
  std::vector<CameraRow> cameras;
  std::vector<CameraShutterRow> shutters;
  std::vector<CameraMountRow> mounts;
  for (std::size_t i = 0; i < project.cameras.size(); ++i) {
    const CameraRecord& camera = project.cameras[i];
    cameras.push_back({camera.id, camera.name, camera.camera.intrinsics()});
    if (camera.readoutSecs != 0) shutters.push_back({std::int64_t(i), camera.readoutSecs});
    if (camera.mount) mounts.push_back({std::int64_t(i), *camera.mount});
  }
  return writeRows(database, "camera", cameras)
      .and_then([&] { return writeRows(database, "camera_shutter", shutters); })
      .and_then([&] { return writeRows(database, "camera_mount", mounts); });
}

Result<void> writeVideos(const ProjectDatabase& database, const Project& project) {
  std::vector<VideoTimingRow> timings;
  for (std::size_t i = 0; i < project.videos.size(); ++i) timings.push_back({std::int64_t(i), project.videos[i].timing});
  return writeRows(database, "video", project.videos).and_then([&] { return writeRows(database, "video_timing", timings); });
}

Result<void> writeTrajectories(const ProjectDatabase& database, const Project& project) {
  std::vector<TrajectoryPoseRow> poses;
  for (std::size_t i = 0; i < project.trajectories.size(); ++i)
    for (const PoseSample& sample : project.trajectories[i].track.samples()) poses.push_back({std::int64_t(i), sample});
  std::vector<FrameTrajectoryRow> served;
  for (std::size_t i = 0; i < project.frames.size(); ++i)
    if (project.frames[i].trajectory) served.push_back({std::int64_t(i), project.frames[i].trajectory});
  return writeRows(database, "trajectory", project.trajectories)
      .and_then([&] { return writeRows(database, "trajectory_pose", poses); })
      .and_then([&] { return writeRows(database, "frame_trajectory", served); });
}

/// `project` with its paths already relative.
Result<void> writeAll(const ProjectDatabase& database, const Project& project) {
  // The file is new and nobody else sees it: no journal is needed, and one fsync ends it all.
  for (const std::string& statement :
       {std::string("PRAGMA journal_mode = OFF"), std::string("PRAGMA synchronous = OFF"),
        "PRAGMA application_id = " + std::to_string(kProjectApplicationId),
        "PRAGMA user_version = " + std::to_string(kProjectVersion), std::string("BEGIN")})
    if (auto done = database.execute(statement); !done) return done;
  for (const std::string& statement : schemaStatements())
    if (auto done = database.execute(statement); !done) return done;

  return writeRows(database, "project", std::vector<ProjectRow>{{project.name, project.crs}})
      .and_then([&] { return writeRows(database, "display", std::vector<DisplaySettings>{project.display}); })
      .and_then([&] { return writePointStyle(database, project.display.points); })
      .and_then([&] { return writeScans(database, project); })
      .and_then([&] { return writeDesigns(database, project); })
      .and_then([&] { return writeCameras(database, project); })
      .and_then([&] { return writeVideos(database, project); })
      .and_then([&] { return writeRows(database, "frame", project.frames); })
      .and_then([&] { return writeTrajectories(database, project); })
      .and_then([&] { return writeRows(database, "stake_point", project.stakePoints); })
      .and_then([&] { return writeRows(database, "control_point", project.controlPoints); })
      .and_then([&] { return writeRows(database, "observation", project.observations); })
      .and_then([&] { return writeRows(database, "annotation", project.annotations); })
      .and_then([&] { return writeRows(database, "finding", project.findings); })
      .and_then([&] { return database.execute("COMMIT"); });
}

/// Refuses by SQLite's own header (sqlite.org/fileformat2.html, 1.3) before SQLite sees the file.
Result<void> checkHeader(const std::string& path) {
  std::vector<std::byte> storage;
  const auto probe = probeFile(path, storage);
  if (!probe) return fail(probe.error());
  const std::string advice = "Choose an Alidade project, a file that ends in .alidade";
  if (probe->isFolder) return fail("This is a folder, not a project file", path, advice);
  if (probe->head.empty()) return fail("The project file is empty", path, "Open a backup of the project");
  if (!probe->startsWith(std::string_view("SQLite format 3\0", 16))) return fail("This is no Alidade project", path, advice);
  if (probe->head.size() < 100) return fail("The project file is cut off", path, "Open a backup of the project");

  const auto number = [&](std::size_t offset, int bytes) {
    std::uint32_t value = 0;
    for (int i = 0; i < bytes; ++i) value = value << 8 | static_cast<std::uint32_t>(probe->head[offset + i]);
    return value;
  };
  if (number(68, 4) != kProjectApplicationId) return fail("This is a database, but no Alidade project", path, advice);
  const std::uint32_t version = number(60, 4);
  if (version > kProjectVersion)
    return fail("The project was saved by a newer Alidade (project version " + std::to_string(version) +
                    "; this one reads up to " + std::to_string(kProjectVersion) + ")", path, "Update Alidade");
  if (version == 0) return fail("The project file has no version: it was never finished", path, "Open a backup of the project");
  const std::uint64_t pageBytes = number(16, 2) == 1 ? 65536 : number(16, 2);
  std::error_code error;
  if (const auto size = fs::file_size(path, error); !error && size < pageBytes * number(28, 4))
    return fail("The project file is cut off: it has " + std::to_string(size) + " of " +
                    std::to_string(pageBytes * number(28, 4)) + " bytes", path, "Open a backup of the project");
  return {};
}

/// Tables that older versions did not write; what they hold keeps its defaults then.
bool isOptional(const std::string& table) {
  static const std::set<std::string> later = {"point_style", "point_cut", "camera_shutter", "camera_mount", "video_timing", "trajectory",
                                              "trajectory_pose", "frame_trajectory"};
  return later.contains(table);
}

/// A foreign hand may have put a view, a virtual or a computed table where a plain one is expected:
/// only plain tables are read, they can neither run code nor grow beyond the file.
Result<void> checkTables(const ProjectDatabase& database, const std::string& path) {
  const std::string advice = "Open a backup of the project";
  QSqlQuery check = database.query();
  if (!check.exec("PRAGMA trusted_schema = OFF") || !check.exec("PRAGMA quick_check(1)") || !check.next())
    return fail(database.error(check, "The project file cannot be checked"));
  if (const QString found = check.value(0).toString(); found != "ok")
    return fail("The project file is damaged: " + found.toStdString(), path, advice);

  std::set<std::string> plain;
  QSqlQuery tables = database.query();
  if (!tables.exec("SELECT name FROM main.sqlite_master WHERE type = 'table' AND rootpage > 0"))
    return fail(database.error(tables, "The project's tables cannot be read"));
  while (tables.next()) plain.insert(tables.value(0).toString().toStdString());
  for (const std::string& statement : schemaStatements()) {
    const std::size_t begin = statement.find("TABLE ") + 6;
    const std::string name = statement.substr(begin, statement.find_first_of(" (", begin) - begin);
    if (!plain.contains(name) && !isOptional(name)) return fail("The project file lacks the table '" + name + "'", path, advice);
    QSqlQuery columns = database.query();
    if (!columns.exec(QString::fromStdString("PRAGMA main.table_xinfo(" + name + ")")))
      return fail(database.error(columns, "The project's tables cannot be read"));
    while (columns.next())
      if (columns.value("hidden").toInt() != 0)
        return fail("The project file has a computed column in the table '" + name + "'", path, advice);
  }
  return {};
}

bool hasTable(const ProjectDatabase& database, const std::string& table) {
  QSqlQuery query = database.query();
  query.prepare("SELECT 1 FROM main.sqlite_master WHERE type = 'table' AND rootpage > 0 AND name = ?");
  query.addBindValue(QString::fromStdString(table));
  return query.exec() && query.next();
}

/// Rows of a list that hangs on another: `add(parent, row)` for each, refused where the parent is not there.
template <class Row, class Parent, class Add>
Result<void> readChildren(const ProjectDatabase& database, const std::string& path, const std::string& table,
                          std::vector<Parent>& parents, Add&& add) {
  if (isOptional(table) && !hasTable(database, table)) return {};
  auto rows = readRows<Row>(database, path, table);
  if (!rows) return fail(rows.error());
  for (Row& row : *rows) {
    if (row.parent < 0 || row.parent >= static_cast<std::int64_t>(parents.size()))
      return fail("The project file is damaged: an entry belongs to nothing", path + ", " + table, "Open a backup of the project");
    add(parents[static_cast<std::size_t>(row.parent)], row);
  }
  return {};
}

template <class T>
Result<void> readInto(const ProjectDatabase& database, const std::string& path, const std::string& table,
                      std::vector<T>& rows) {
  if (isOptional(table) && !hasTable(database, table)) return {};
  auto read = readRows<T>(database, path, table);
  if (!read) return fail(read.error());
  rows = std::move(*read);
  return {};
}

Result<void> readHead(const ProjectDatabase& database, const std::string& path, Project& project) {
  const auto heads = readRows<ProjectRow>(database, path, "project", false);
  if (!heads) return fail(heads.error());
  const auto displays = readRows<DisplaySettings>(database, path, "display", false);
  if (!displays) return fail(displays.error());
  if (heads->size() != 1 || displays->size() != 1)
    return fail("The project file is damaged: it must describe one project", path, "Open a backup of the project");
  project.name = heads->front().name;
  project.crs = heads->front().crs;
  project.display = displays->front();
  if (!hasTable(database, "point_style")) return {};
  const auto styles = readRows<PointStyle>(database, path, "point_style", false);
  if (!styles) return fail(styles.error());
  if (styles->size() != 1)
    return fail("The project file is damaged: it must have one point style", path, "Open a backup of the project");
  project.display.points = styles->front();
  std::vector<PointCutRow> cuts;
  if (auto read = readInto(database, path, "point_cut", cuts); !read) return read;
  for (const PointCutRow& row : cuts) project.display.points.cuts.push_back(row.cut);
  return {};
}

Result<void> readTrajectories(const ProjectDatabase& database, const std::string& path, Project& project) {
  std::vector<std::vector<PoseSample>> samples;
  auto done = readInto(database, path, "trajectory", project.trajectories)
      .and_then([&] {
        samples.resize(project.trajectories.size());
        return readChildren<TrajectoryPoseRow>(database, path, "trajectory_pose", samples,
            [](std::vector<PoseSample>& list, TrajectoryPoseRow& row) { list.push_back(row.sample); });
      })
      .and_then([&] {
        return readChildren<FrameTrajectoryRow>(database, path, "frame_trajectory", project.frames,
            [](Frame& frame, FrameTrajectoryRow& row) { frame.trajectory = row.trajectory; });
      });
  if (!done) return done;
  for (std::size_t i = 0; i < samples.size(); ++i) project.trajectories[i].track = PoseTrack(std::move(samples[i]));
  return {};
}

Result<void> readAll(const ProjectDatabase& database, const std::string& path, Project& project) {
  std::vector<CameraRow> cameras;
  auto done = readHead(database, path, project)
      .and_then([&] { return readInto(database, path, "scan", project.scans); })
      .and_then([&] {
        return readChildren<ScanAttributeRow>(database, path, "scan_attribute", project.scans,
            [](Scan& scan, ScanAttributeRow& row) { scan.info.attributes.push_back(std::move(row.name)); });
      })
      .and_then([&] {
        return readChildren<ScanStationRow>(database, path, "scan_station", project.scans,
            [](Scan& scan, ScanStationRow& row) { scan.info.stations.push_back(std::move(row.station)); });
      })
      .and_then([&] { return readInto(database, path, "design", project.designs); })
      .and_then([&] {
        return readChildren<HiddenElementRow>(database, path, "design_hidden_element", project.designs,
            [](Design& design, HiddenElementRow& row) { design.hiddenElements.push_back(std::move(row.globalId)); });
      })
      .and_then([&] { return readInto(database, path, "camera", cameras); })
      .and_then([&] { return readInto(database, path, "video", project.videos); })
      .and_then([&] {
        return readChildren<VideoTimingRow>(database, path, "video_timing", project.videos,
            [](Video& video, VideoTimingRow& row) { video.timing = row.timing; });
      })
      .and_then([&] { return readInto(database, path, "frame", project.frames); })
      .and_then([&] { return readTrajectories(database, path, project); })
      .and_then([&] { return readInto(database, path, "stake_point", project.stakePoints); })
      .and_then([&] { return readInto(database, path, "control_point", project.controlPoints); })
      .and_then([&] { return readInto(database, path, "observation", project.observations); })
      .and_then([&] { return readInto(database, path, "annotation", project.annotations); })
      .and_then([&] { return readInto(database, path, "finding", project.findings); });
  if (!done) return done;
  for (CameraRow& row : cameras) {
    const bool blank = row.intrinsics.width == 0;
    project.cameras.push_back({row.id, std::move(row.name), blank ? Camera() : Camera(row.intrinsics)});
  }
  return readChildren<CameraShutterRow>(database, path, "camera_shutter", project.cameras,
      [](CameraRecord& camera, CameraShutterRow& row) { camera.readoutSecs = row.readoutSecs; })
      .and_then([&] {
        return readChildren<CameraMountRow>(database, path, "camera_mount", project.cameras,
            [](CameraRecord& camera, CameraMountRow& row) { camera.mount = std::move(row.mount); });
      });
}

}  // namespace

Result<void> saveProject(const Project& project, const std::string& path) {
  auto file = AtomicFile::create(path);
  if (!file) return fail(file.error());
  if (file->isDirect()) return fail("A project can only be saved to an ordinary file", path, "Give a file name");

  Project stored = project;
  forEachSource(stored, [&](SourceFile& source) { source.path = pathRelativeToProject(source.path, path); });
  {
    const auto database = ProjectDatabase::open(file->temporaryPath(), ProjectDatabase::Mode::Write);
    auto written = database ? writeAll(*database, stored) : Result<void>(fail(database.error()));
    if (!written) {
      Error error = written.error();
      error.where = path;  // the temporary name says nothing to the user
      return fail(std::move(error));
    }
  }
  return file->commit();
}

Result<Project> loadProject(const std::string& path) {
  if (auto header = checkHeader(path); !header) return fail(header.error());
  const auto database = ProjectDatabase::open(path, ProjectDatabase::Mode::Read);
  if (!database) return fail(database.error());
  if (auto tables = checkTables(*database, path); !tables) return fail(tables.error());

  Project project;
  if (auto read = readAll(*database, path, project); !read) return fail(read.error());
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error).lexically_normal();
  project.path = error ? path : absolute.string();
  forEachSource(project, [&](SourceFile& source) { source.path = pathFromProject(source.path, path); });
  return project;
}

}  // namespace alidade
