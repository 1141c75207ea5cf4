// SPDX-License-Identifier: LGPL-2.1-or-later
// A subject: meshes and strands, posed before the camera.
#pragma once

#include <string>
#include <vector>

#include "skin.hpp"

namespace inverse::olat {

struct Triangle {
  std::uint32_t a, b, c;
};

/// Triangles of one part. `rest` are the places at rest that textures are functions of.
struct Mesh {
  Part part = Part::skin;
  std::vector<Vec> positions, rest, normals;
  std::vector<Triangle> triangles;
  Vec center, axis;  ///< of an eye: its center and where it looks

  void find_normals();
  /// A closed grid of rows × columns over directions; `place` gives the position for a direction.
  template <class Place>
  static Mesh sphere(Part part, int rows, int columns, Place place);
};

/// A hair: a line of points, its radius at the root and at the tip.
struct Strand {
  std::vector<Vec> points;
  float root = 0.05f, tip = 0.02f;
  bool brow = false;
};

struct Subject {
  std::vector<Mesh> meshes;
  std::vector<Strand> strands;
  Landmarks marks;
  Vec center;         ///< of the head, which the camera looks at
  float height = 28;  ///< of the head, cm
};

/// Blend shapes of a head of ICT FaceKit: vertices = neutral + Σ w · delta.
struct HeadModel {
  std::vector<Vec> neutral;
  std::vector<std::vector<Vec>> identities, expressions;
  struct Group {
    Part part;
    int eye;  ///< 1: right (x < 0), 2: left; 0: none
    std::vector<Triangle> triangles;
  };
  std::vector<Group> groups;
};

/// `trait` in 0 … 1 is what splits are made by: it rules the overall shape.
Subject head_of(const HeadModel& model, Random& random, float trait);
Subject bust(Random& random, float trait);
Subject sphere_subject();  ///< radius 10, for checks

/// Hair on the head, beard and brows, on the meshes that are there.
void grow_hair(Subject& subject, Random& random);
void dress(Subject& subject, Random& random, float width);

template <class Place>
Mesh Mesh::sphere(Part part, int rows, int columns, Place place) {
  Mesh mesh;
  mesh.part = part;
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const float theta = kPi * float(i) / float(rows), phi = 2 * kPi * float(j) / float(columns);
      mesh.positions.push_back(place(
          Vec{std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)}));
    }
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const auto at = [&](int r, int c) { return std::uint32_t(r * columns + c % columns); };
      if (i > 0) mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i < rows - 1) mesh.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
    }
  mesh.rest = mesh.positions;
  mesh.find_normals();
  return mesh;
}

}  // namespace inverse::olat
