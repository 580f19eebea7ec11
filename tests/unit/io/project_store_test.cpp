// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/project_store.h"

#include <bit>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>
#include <random>
#include <thread>

#include <QSqlDatabase>
#include <QSqlQuery>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/resource.h>

#include "io/project_fields.h"
#include "unit/io/test_folder.h"

namespace alidade {

namespace {

/// Writes every member into one line of text, doubles by their bits: two projects are the same
/// where their lines are.
class Printer {
 public:
  void operator()(const char* column, double& value) {
    const std::uint64_t bits = std::isnan(value) ? 0x7ff8000000000000ull : std::bit_cast<std::uint64_t>(value);
    add(column, std::to_string(bits));
  }
  void operator()(const char* column, std::string& value) { add(column, value); }
  template <class Tag>
  void operator()(const char* column, Id<Tag>& id) { add(column, std::to_string(id.value)); }
  template <class T>
    requires std::is_integral_v<T>
  void operator()(const char* column, T& value) { add(column, std::to_string(value)); }
  template <class E>
  void choice(const char* column, E& value, std::initializer_list<const char*>) {
    add(column, std::to_string(static_cast<int>(value)));
  }
  void check(bool, const char*, const std::string&) {}
  void add(const char* column, const std::string& value) { text += std::string(column) + "=" + value + ";\n"; }
  template <class T>
  void list(const char* name, std::vector<T> items) {
    add(name, std::to_string(items.size()));
    for (T& item : items) visit(*this, item);
  }
  std::string text;
};

std::string printed(Project project) {
  Printer p;
  ProjectRow head{project.name, project.crs};
  visit(p, head);
  visit(p, project.display);
  visit(p, project.display.points);
  p.list("scans", project.scans);
  for (Scan& scan : project.scans) {
    for (std::string& attribute : scan.info.attributes) p("attribute", attribute);
    for (Station& station : scan.info.stations) {
      ScanStationRow row{0, station};
      visit(p, row);
    }
  }
  p.list("designs", project.designs);
  for (Design& design : project.designs)
    for (std::string& element : design.hiddenElements) p("hidden", element);
  for (CameraRecord& camera : project.cameras) {
    CameraRow row{camera.id, camera.name, camera.camera.intrinsics()};
    visit(p, row);
    p("readout", camera.readoutSecs);
    if (!camera.mount) continue;
    CameraMountRow mount{0, *camera.mount};
    visit(p, mount);
  }
  p.list("videos", project.videos);
  for (Video& video : project.videos) p.choice("timing", video.timing, {});
  p.list("trajectories", project.trajectories);
  for (Trajectory& trajectory : project.trajectories)
    for (const PoseSample& sample : trajectory.track.samples()) {
      TrajectoryPoseRow row{0, sample};
      visit(p, row);
    }
  for (Frame& frame : project.frames) p("trajectory", frame.trajectory);
  p.list("frames", project.frames);
  p.list("stakePoints", project.stakePoints);
  p.list("controlPoints", project.controlPoints);
  p.list("observations", project.observations);
  p.list("annotations", project.annotations);
  p.list("findings", project.findings);
  return p.text;
}

/// Fills every member that project_fields.h names with something of its own.
class Filler {
 public:
  void operator()(const char*, double& value) { value = m_normal(m_random) * 1e5; }
  void operator()(const char*, std::string& value) { value = std::string("ünï ").append(std::to_string(m_random())); }
  void operator()(const char*, bool& value) { value = m_random() % 2 == 0; }
  template <class Tag>
  void operator()(const char*, Id<Tag>& id) { id.value = static_cast<std::int64_t>(m_random() >> 1); }
  template <class T>
    requires std::is_integral_v<T>
  void operator()(const char*, T& value) { value = static_cast<T>(m_random() >> 1); }
  template <class E>
  void choice(const char*, E& value, std::initializer_list<const char*> names) { value = static_cast<E>(m_random() % names.size()); }
  void check(bool, const char*, const std::string&) {}

 private:
  std::mt19937_64 m_random{7};
  std::normal_distribution<double> m_normal;
};

RigidTransform somePose(double turn) {
  return {glm::normalize(glm::dquat(0.3 + turn, -0.2, 0.8, 0.1)), {100600.123456789, 196250.1, -turn}};
}

Project fullProject(const TestFolder& folder) {
  Project project;
  Filler fill;
  project.name = "Straße Nord";
  project.crs = "EPSG:31370";
  visit(fill, project.display);
  visit(fill, project.display.points);
  project.display.points.hiddenClasses.set(7).set(18).set(255);
  project.display.points.cuts = {{true, {100600.5, 196250.25, -0.0}, 0.1, -0.2}, {false, {1, 2, 3}, 4, 1.5}};
  project.scans.resize(2);
  project.designs.resize(2);
  for (auto& scan : project.scans) {
    visit(fill, scan);
    scan.source.path = folder / "scans/hall.las";
    scan.info.attributes = {"rgb", "intensity"};
    scan.info.stations = {{"S1", somePose(0.1), 12, 4000000000u}, {"S2", somePose(0.2), 0, 0}};
  }
  project.scans[1].info.bounds = Bounds();  // infinite
  project.scans[1].info.pointCount = ~std::uint64_t(0);
  for (auto& design : project.designs) {
    visit(fill, design);
    design.source.path = "/common/road.ifc";
    design.hiddenElements = {"2O2Fr$t4X7Zf8NOew3FLOH", ""};
  }
  Intrinsics lens;
  lens.model = CameraModel::OpenCv14;
  lens.width = 5472;
  lens.height = 3648;
  lens.fx = 3693.1569475809993;
  lens.fy = 3693.2;
  lens.cx = 2731.4405032761174;
  lens.cy = 1846.49;
  lens.distortion.k = {-0.264, 0.1075, -0.03, 0, 0, 0};
  lens.distortion.q = {1e-3, 2e-3, 3e-3};
  lens.distortion.s = {1e-5, 2e-5, 3e-5, 4e-5};
  lens.distortion.p1 = -0.0005;
  lens.distortion.tauX = 0.001;
  const Intrinsics skewed = Intrinsics::fromParameters(CameraModel::BrownSkewed, 640, 480,
                                                       {500, 501, 320, 240, -0.2, 0.05, -0.01, 0.002, 1e-3, -2e-3, 0.1, -0.05, 0.004}).value();
  project.cameras = {{CameraId{4}, "drone", Camera(lens)}, {CameraId{5}, "none", Camera()}, {CameraId{6}, "skewed", Camera(skewed)}};
  project.videos.resize(2);
  for (auto& video : project.videos) visit(fill, video), video.source.path = folder / "v.mp4";
  project.videos[1].timing = FrameTiming::Table;
  project.cameras[2].readoutSecs = 0.0123456789;
  project.cameras[1].mount = CameraMount{"IMU", somePose(0.4), {1e-3, 2e-3, 3e-3}, {1e-4, 2e-4, 3e-4}};
  project.trajectories.resize(2);
  for (auto& trajectory : project.trajectories) visit(fill, trajectory), trajectory.source.path = folder / "t.txt";
  project.trajectories[0].clockOffsetStdSecs.reset();
  project.trajectories[1].clockOffsetStdSecs = 1.25e-4;
  project.trajectories[1].track = PoseTrack({{1.7e9 + 0.1, somePose(0.1)}, {1.7e9 + 0.2, somePose(0.2)}});
  project.frames.resize(3);
  for (auto& frame : project.frames) {
    visit(fill, frame);
    frame.image.path = folder / "pictures/f.png";
    frame.cameraFromWorld.reset();
    frame.originalCameraFromWorld.reset();
    frame.quality.reset();
  }
  project.frames[0].cameraFromWorld = somePose(0.5);
  project.frames[2].trajectory = project.trajectories[1].id;
  project.frames[1].cameraFromWorld = somePose(0.7);
  project.frames[1].originalCameraFromWorld = somePose(0.9);
  project.frames[1].quality = PoseQuality{0.3, 1.1, {1e-3, 2e-3, 3e-3}, {1e-6, 0, -0.0}, 20};
  project.stakePoints.resize(3);
  for (auto& point : project.stakePoints) visit(fill, point);
  project.controlPoints.resize(2);
  for (auto& point : project.controlPoints) visit(fill, point);
  project.observations.resize(2);
  for (auto& observation : project.observations) visit(fill, observation);
  project.annotations.resize(4);
  for (auto& annotation : project.annotations) visit(fill, annotation);
  project.findings.resize(2);
  for (auto& finding : project.findings) visit(fill, finding);
  project.findings[0].world = {-0.0, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::quiet_NaN()};
  project.findings[1].world = {std::numeric_limits<double>::infinity(), 1e300, 1234567.0};
  project.findings[0].text = std::string("zero \0 and not UTF-8 \xff", 22);
  return project;
}

/// Runs SQL on the file behind the store's back.
void tamper(const std::string& path, const QString& statement) {
  {
    QSqlDatabase database = QSqlDatabase::addDatabase("QSQLITE", "tamper");
    database.setDatabaseName(QString::fromStdString(path));
    ASSERT_TRUE(database.open());
    QSqlQuery query(database);
    ASSERT_TRUE(query.exec(statement)) << statement.toStdString();
  }
  QSqlDatabase::removeDatabase("tamper");
}

std::string savedProject(const TestFolder& folder) {
  const std::string path = folder / "p.alidade";
  const auto saved = saveProject(fullProject(folder), path);
  EXPECT_TRUE(saved) << saved.error().text();
  return path;
}

}  // namespace

TEST(ProjectStore, KeepsEveryMemberBitForBit) {
  const TestFolder folder;
  const Project project = fullProject(folder);
  const std::string path = folder / "p.alidade";
  const auto saved = saveProject(project, path);
  ASSERT_TRUE(saved) << saved.error().text();
  const auto loaded = loadProject(path);
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(printed(*loaded), printed(project));
  EXPECT_EQ(loaded->path, path);
  EXPECT_EQ(folder.count(), 1u) << "nothing is left beside the project";
}

TEST(ProjectStore, KeepsAnEmptyProject) {
  const TestFolder folder;
  ASSERT_TRUE(saveProject(Project(), folder / "empty.alidade"));
  const auto loaded = loadProject(folder / "empty.alidade");
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(printed(*loaded), printed(Project()));
}

TEST(ProjectStore, FindsItsSourcesAfterTheFolderMoved) {
  const TestFolder folder;
  std::filesystem::create_directories(folder / "a/job");
  Project project;
  project.scans.resize(2);
  project.scans[0].source.path = folder / "a/job/scans/s.las";
  project.scans[1].source.path = folder / "a/common/t.las";
  ASSERT_TRUE(saveProject(project, folder / "a/job/p.alidade"));
  std::filesystem::rename(folder / "a", folder / "b");
  const auto loaded = loadProject(folder / "b/job/p.alidade");
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(loaded->scans[0].source.path, folder / "b/job/scans/s.las");
  EXPECT_EQ(loaded->scans[1].source.path, folder / "b/common/t.las");
}

TEST(ProjectStore, WorksInAnyThread) {
  const TestFolder folder;
  std::vector<std::thread> threads;
  std::atomic<int> good{0};
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] {
      const std::string path = folder / std::to_string(i).append(".alidade");
      for (int k = 0; k < 3; ++k)
        if (saveProject(fullProject(folder), path) && loadProject(path)) ++good;
    });
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(good, 12);
}

TEST(ProjectStore, AFullDiskLeavesTheOldProjectWhole) {
  const TestFolder folder;
  const std::string path = savedProject(folder);
  const std::string before = TestFolder::read(path);
  Project larger = fullProject(folder);
  for (int i = 0; i < 5000; ++i) larger.stakePoints.push_back({std::to_string(i), {1, 2, 3}, "", 0.02});

  // A file may not grow beyond 64 KiB, as on a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit tight{64 << 10, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &tight);
  const auto saved = saveProject(larger, path);
  setrlimit(RLIMIT_FSIZE, &old);

  ASSERT_FALSE(saved);
  EXPECT_FALSE(saved.error().advice.empty());
  EXPECT_EQ(saved.error().where, path);
  EXPECT_EQ(TestFolder::read(path), before);
  EXPECT_EQ(folder.count(), 1u) << "the unfinished file is gone";
}

TEST(ProjectStore, KeepsAProjectWhosePathIsNotUtf8) {
  const TestFolder folder;
  const std::string path = folder / "Stra\xdf" "e.alidade";
  Project project;
  project.name = "Latin-1";
  ASSERT_TRUE(saveProject(project, path));
  const auto loaded = loadProject(path);
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(loaded->name, "Latin-1");
  EXPECT_EQ(folder.count(), 1u) << "nothing beside it under another name";
}

TEST(ProjectStore, RefusesAFolderThatIsNotThere) {
  const TestFolder folder;
  const auto saved = saveProject(Project(), folder / "no/such/p.alidade");
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().what, "The folder does not exist");
  EXPECT_FALSE(saveProject(Project(), folder.path().string()));
}

TEST(ProjectStore, RefusesWhatIsNoProject) {
  const TestFolder folder;
  EXPECT_EQ(loadProject(folder / "none.alidade").error().what, "The file does not exist");
  EXPECT_EQ(loadProject(folder.write("e.alidade", "")).error().what, "The project file is empty");
  EXPECT_EQ(loadProject(folder.write("t.alidade", "hello")).error().what, "This is no Alidade project");
  EXPECT_THAT(loadProject(folder.path().string()).error().what, testing::HasSubstr("folder"));
  tamper(folder / "foreign.db", "CREATE TABLE t (x)");
  EXPECT_EQ(loadProject(folder / "foreign.db").error().what, "This is a database, but no Alidade project");
}

TEST(ProjectStore, RefusesANewerVersionByName) {
  const TestFolder folder;
  const std::string path = savedProject(folder);
  tamper(path, "PRAGMA user_version = 99");
  const auto loaded = loadProject(path);
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().what, testing::HasSubstr("99"));
  EXPECT_EQ(loaded.error().advice, "Update Alidade");
}

TEST(ProjectStore, ReadsAProjectOfVersionOne) {
  const TestFolder folder;
  const std::string path = savedProject(folder);
  tamper(path, "DROP TABLE point_style");
  tamper(path, "PRAGMA user_version = 1");
  const auto loaded = loadProject(path);
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(loaded->display.points, PointStyle());
}

TEST(ProjectStore, ReadsAProjectOfVersionTwo) {
  const TestFolder folder;
  const std::string path = savedProject(folder);
  const auto whole = loadProject(path);
  ASSERT_TRUE(whole) << whole.error().text();
  for (const char* column : {"depth_m", "kind", "e2", "n2", "h2", "sigma_m", "held_out"})
    tamper(path, QStringLiteral("ALTER TABLE observation DROP COLUMN %1").arg(column));
  for (const char* table : {"camera_shutter", "camera_mount", "video_timing", "trajectory", "trajectory_pose", "frame_trajectory"})
    tamper(path, QStringLiteral("DROP TABLE %1").arg(table));
  // Of this version the columns are missed, of an older one they take their defaults.
  EXPECT_FALSE(loadProject(path));
  tamper(path, "PRAGMA user_version = 2");
  const auto loaded = loadProject(path);
  ASSERT_TRUE(loaded) << loaded.error().text();
  ASSERT_EQ(loaded->observations.size(), whole->observations.size());
  ASSERT_FALSE(loaded->observations.empty());
  EXPECT_EQ(loaded->observations[0].name, whole->observations[0].name);
  EXPECT_EQ(loaded->observations[0].pixel, whole->observations[0].pixel);
  EXPECT_EQ(loaded->observations[0].kind, ObservedKind::Control);
  EXPECT_EQ(loaded->observations[0].sigmaM, 0);
  EXPECT_TRUE(loaded->trajectories.empty());
  EXPECT_EQ(loaded->cameras[2].readoutSecs, 0);
  EXPECT_FALSE(loaded->frames[2].trajectory);
  EXPECT_TRUE(loaded->frames[1].cameraFromWorld) << "poses that were there stay";
}

TEST(ProjectStore, ReadsAProjectOfVersionThree) {
  const TestFolder folder;
  Project project = *loadProject(savedProject(folder));
  project.display.levelThreshold = LevelThreshold::ByPoint;
  const std::string path = folder / "points.alidade";
  ASSERT_TRUE(saveProject(project, path));
  EXPECT_EQ(loadProject(path)->display.levelThreshold, LevelThreshold::ByPoint);
  tamper(path, "ALTER TABLE display DROP COLUMN level_threshold");
  EXPECT_FALSE(loadProject(path));
  tamper(path, "PRAGMA user_version = 3");
  const auto loaded = loadProject(path);
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(loaded->display.levelThreshold, LevelThreshold::ByDistance);
}

TEST(ProjectStore, ReadsAProjectOfVersionFive) {
  const TestFolder folder;
  const std::string path = savedProject(folder);
  ASSERT_EQ(loadProject(path)->display.points.cuts.size(), 2u);
  tamper(path, "DROP TABLE point_cut");
  tamper(path, "PRAGMA user_version = 5");
  const auto loaded = loadProject(path);
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_TRUE(loaded->display.points.cuts.empty());
}

TEST(ProjectStore, ReadsAProjectOfVersionFour) {
  const TestFolder folder;
  Project project = *loadProject(savedProject(folder));
  ASSERT_FALSE(project.observations.empty());
  project.observations[0].kind = ObservedKind::Depth, project.observations[0].depthM = 7.5;
  const std::string path = folder / "depth.alidade";
  ASSERT_TRUE(saveProject(project, path));
  EXPECT_EQ(loadProject(path)->observations[0].depthM, 7.5);
  tamper(path, "ALTER TABLE observation DROP COLUMN depth_m");
  tamper(path, "DROP TABLE camera_mount");
  EXPECT_FALSE(loadProject(path));
  tamper(path, "PRAGMA user_version = 4");
  const auto loaded = loadProject(path);
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(loaded->observations[0].depthM, 0);
  EXPECT_FALSE(loaded->cameras[1].mount);
}

TEST(ProjectStore, RefusesEveryTruncation) {
  const TestFolder folder;
  const std::string whole = TestFolder::read(savedProject(folder));
  for (std::size_t size = 0; size < whole.size(); size += 997)
    EXPECT_FALSE(loadProject(folder.write("cut.alidade", whole.substr(0, size)))) << size;
}

TEST(ProjectStore, SurvivesFlippedBytes) {
  const TestFolder folder;
  const std::string whole = TestFolder::read(savedProject(folder));
  std::mt19937 random(3);
  for (int i = 0; i < 300; ++i) {
    std::string broken = whole;
    for (int k = 0; k < 8; ++k) broken[random() % broken.size()] = static_cast<char>(random());
    const auto loaded = loadProject(folder.write("flip.alidade", broken));
    if (!loaded) { EXPECT_FALSE(loaded.error().what.empty()); }
  }
}

TEST(ProjectStore, RefusesWrongValuesByTableAndColumn) {
  const std::pair<const char*, const char*> cases[] = {
      {"UPDATE frame SET qw = 'north'", "qw"},
      {"UPDATE frame SET has_pose = 7", "has_pose"},
      {"UPDATE frame SET qw = 9e999 WHERE has_pose = 1", "qw"},
      {"UPDATE frame SET pose_source = 'guessed'", "pose_source"},
      {"UPDATE camera SET model = 'FOV'", "model"},
      {"UPDATE camera SET fx = -1 WHERE width > 0", "fx"},
      {"UPDATE annotation SET red = 256", "red"},
      {"UPDATE stake_point SET name = 12", "name"},
      {"UPDATE scan_station SET scan = 99", "belongs to nothing"},
      {"DELETE FROM display", "one project"},
      {"DELETE FROM point_style", "one point style"},
      {"UPDATE point_style SET hidden_classes = '7 256'", "hidden_classes"},
      {"DROP TABLE finding", "finding"},
      {"UPDATE trajectory_pose SET trajectory = 2", "belongs to nothing"},
      {"UPDATE trajectory_pose SET time_s = NULL", "time_s"},
      {"UPDATE trajectory SET clock_offset_s = 'late'", "clock_offset_s"},
      {"UPDATE camera_shutter SET readout_s = 9e999", "readout_s"},
      {"UPDATE camera_mount SET camera = 3", "belongs to nothing"},
      {"UPDATE camera_mount SET qw = 9e999", "qw"},
      {"UPDATE video_timing SET timing = 'guessed'", "timing"},
      {"UPDATE frame_trajectory SET frame = -1", "belongs to nothing"},
      {"ALTER TABLE video ADD COLUMN bomb GENERATED ALWAYS AS (zeroblob(1000000000))", "video"},
  };
  for (const auto& [statement, word] : cases) {
    const TestFolder folder;
    const std::string path = savedProject(folder);
    tamper(path, statement);
    const auto loaded = loadProject(path);
    ASSERT_FALSE(loaded) << statement;
    EXPECT_THAT(loaded.error().text(), testing::HasSubstr(word)) << statement;
  }
}

TEST(ProjectStore, RefusesAViewThatNeverEnds) {
  const TestFolder folder;
  const std::string path = savedProject(folder);
  tamper(path, "DROP TABLE project");
  tamper(path, "CREATE VIEW project AS WITH RECURSIVE r(name, crs) AS "
               "(SELECT 'a', 'b' UNION ALL SELECT name, crs FROM r) SELECT * FROM r");
  const auto loaded = loadProject(path);
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().what, testing::HasSubstr("'project'"));
}

TEST(ProjectStore, DoesNotSaveWhatItCouldNotRead) {
  const TestFolder folder;
  Project project;
  project.frames.resize(1);
  project.frames[0].cameraFromWorld = RigidTransform{glm::dquat(0, 0, 0, 0), {}};
  const auto saved = saveProject(project, folder / "p.alidade");
  ASSERT_FALSE(saved);
  EXPECT_THAT(saved.error().what, testing::HasSubstr("frame 1"));
  EXPECT_EQ(folder.count(), 0u);
}

TEST(ProjectStore, KeepsALinkAndTheFilesMode) {
  const TestFolder folder;
  std::filesystem::create_directories(folder / "real");
  ASSERT_TRUE(saveProject(Project(), folder / "real/p.alidade"));
  std::filesystem::permissions(folder / "real/p.alidade", std::filesystem::perms(0640));
  std::filesystem::create_symlink(folder / "real/p.alidade", folder / "link.alidade");
  ASSERT_TRUE(saveProject(fullProject(folder), folder / "link.alidade"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.alidade"));
  EXPECT_EQ(std::filesystem::status(folder / "real/p.alidade").permissions(), std::filesystem::perms(0640));
  EXPECT_EQ(loadProject(folder / "real/p.alidade")->name, "Straße Nord");
}

}  // namespace alidade
