// SPDX-License-Identifier: LGPL-2.1-or-later
// The program that reads meshes: one that works, and others that end badly.
#include "gst/material/mesh/mesh_process.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "gst/material/mesh/mesh_file.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

class MeshProcess : public ::testing::Test {
 protected:
  /// A reader that does this in a shell.
  std::string reader(const std::string& does) const {
    const std::string path = folder_.write("reader", "#!/bin/sh\n" + does + "\n");
    chmod(path.c_str(), 0755);
    return path;
  }
  std::string failure_of(const std::string& does) const {
    std::string warning;
    std::string text =
        error_of([&] { load_mesh("a.obj", warning, reader(does)); }, ErrorKind::file);
    expect_contains(text, "mesh a.obj cannot be read");
    EXPECT_EQ(warning, "");
    return text;
  }

  TemporaryFolder folder_;
};

}  // namespace

TEST_F(MeshProcess, GivesWhatIsRead) {
  const std::string path = folder_.write("-a b'.obj",
                                         "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 nan\n"
                                         "f 1 2 3\nf 1 3 4\n");
  std::string warning, expected_warning;
  const Mesh expected = parse_mesh(path, expected_warning);
  const Mesh mesh = load_mesh(path, warning, MESH_READER);
  EXPECT_EQ(warning, expected_warning);
  expect_contains(warning, "1 of 2 faces were dropped");
  EXPECT_EQ(mesh.positions, expected.positions);
  EXPECT_EQ(mesh.normals, expected.normals);
  EXPECT_EQ(mesh.indices, expected.indices);
}

TEST_F(MeshProcess, GivesTheErrorsOfFiles) {
  for (const std::string& path : {folder_ / "none.obj", folder_.write("a.txt", "v"),
                                  folder_.write("b.obj", "v 0 0 0\n"), folder_.path()}) {
    std::string warning;
    const std::string expected = error_of([&] { parse_mesh(path, warning); }, ErrorKind::file);
    EXPECT_EQ(error_of([&] { load_mesh(path, warning, MESH_READER); }, ErrorKind::file), expected);
    EXPECT_NE(expected, "");
  }
}

TEST_F(MeshProcess, SaysWhatAReaderDiedOf) {
  expect_contains(failure_of("kill -SEGV $$"), "its reader failed");
  expect_contains(failure_of("kill -XCPU $$"), "takes more than a minute");
  expect_contains(failure_of("exit 0"), "its reader failed");
  expect_contains(failure_of("echo 0123456789012345678901234567890"), "its reader failed");
  expect_contains(failure_of("cat /dev/zero"), "its reader failed");
  // So many vertices, and other numbers of them.
  const auto header = [](const std::string& vertices) {
    return R"(printf 'MESH\000\000\000\000\000\000\000\000)" + vertices + R"(\003\000\000\000')";
  };
  expect_contains(failure_of(header(R"(\377\377\377\377)")), "its reader failed");
  expect_contains(failure_of(header(R"(\001\000\000\000)")), "its reader failed");
  expect_contains(failure_of(header(R"(\001\000\000\000)") + "; head -c 30 /dev/zero; printf '" +
                             R"(\001\000\000\000\000\000')"),
                  "its reader failed");
  std::string warning;
  expect_contains(error_of([&] { load_mesh("a.obj", warning, folder_ / "none"); }, ErrorKind::file),
                  "install gst-inverse anew");
}

}  // namespace inverse::testing
