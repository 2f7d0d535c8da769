// SPDX-License-Identifier: BSD-3-Clause
// Tool paths as CAM programs, spreadsheets and scripts write them.
#include <algorithm>
#include <cmath>

#include "problem_support.hpp"
#include "seed.hpp"

namespace swivel::io::test {
namespace {

using swivel::test::Random;

/// The folder of a problem whose path is a file.
class CamFolder {
 public:
  /// Loads the problem with `keys` of the path beside `file`, whose text is given.
  [[nodiscard]] PathProblem load(const std::string& name, const std::string& text,
                                 const std::string& keys = "") const {
    folder_.folder().write("problems/" + name, text);
    return folder_.load({{"path", "{file: " + name + keys + "}"}});
  }
  /// Returns the message with which the file is refused.
  [[nodiscard]] std::string refusal(const std::string& name, const std::string& text,
                                    const std::string& keys = "") const {
    SCOPED_TRACE(text.substr(0, 300));
    return input_error([&] { (void)load(name, text, keys); });
  }
  /// Loads a job with one stroke.
  [[nodiscard]] Problem load_job(const std::string& name, const std::string& text,
                                 const std::string& keys = "") const {
    folder_.folder().write("problems/" + name, text);
    const fs::path file = folder_.folder().write(
        "problems/job.yaml",
        "robot: {urdf: ../robots/arm.urdf, base_link: base_link, tip_link: link_7}\n"
        "strokes: [{name: a, path: {file: " +
            name + keys + "}}]\n");
    return io::load_job(file);
  }

 private:
  ProblemFolder folder_;
};

/// Returns the tool's z axis at a waypoint.
Vector3d z_of(const Waypoint& waypoint) {
  return waypoint.orientation.toRotationMatrix().col(2);
}
Vector3d x_of(const Waypoint& waypoint) {
  return waypoint.orientation.toRotationMatrix().col(0);
}

void expect_near(const Vector3d& a, const Vector3d& b, double tolerance = 1e-12) {
  EXPECT_LE((a - b).norm(), tolerance) << a.transpose() << " | " << b.transpose();
}

bool said(const PathProblem& problem, const std::string& words) {
  return std::any_of(
      problem.model->warnings.begin(), problem.model->warnings.end(),
      [&](const std::string& line) { return line.find(words) != std::string::npos; });
}

TEST(PathTable, OneTableInManyDialects) {
  const CamFolder folder;
  const char* const tables[] = {
      "x,y,z,qw,qx,qy,qz\n0.5,-0.25,0.3,0,0,1,0\n0.5,0.25,0.3,0,0,1,0\n",
      "\xef\xbb\xbfx,y,z,qw,qx,qy,qz\r\n0.5,-0.25,0.3,0,0,1,0\r\n0.5,0.25,0.3,0,0,1,0\r\n",
      "x,y,z,qw,qx,qy,qz\r0.5,-0.25,0.3,0,0,1,0\r0.5,0.25,0.3,0,0,1,0",
      "x;y;z;qw;qx;qy;qz\n0,5;-0,25;0,3;0;0;1;0\n,5;,25;0,3;0;0;1,0;0\n",
      "sep=;\nx;y;z;qw;qx;qy;qz\n0.5;-0.25;0.3;0;0;1;0\n0.5;0.25;0.3;0;0;1;0\n",
      "X\tY\tZ\tQW\tQX\tQY\tQZ\n0.5\t-0.25\t0.3\t0\t0\t1\t0\n\n0.5\t0.25\t0.3\t0\t0\t1\t0\n\t\n",
      "x  y z qw qx   qy qz\n 0.5 -0.25 0.3 0 0 1 0\n0.5 +.25 3e-1 0 0 1 0 \n",
      "% a script\n# x y z qw qx qy qz\n0.5 -0.25 0.3 0 0 1 0\n0.5 0.25 0.3 0 0 1 0\n",
      "// made by hand\nqx, qy,qz,qw, z,y,x\n# here\n0,1,0,0,0.3,-0.25,0.5\n0,1,0,0,0.3,0.25,0.5\n",
      "\"x\",\"y\",\"z\",\"qw\",\"qx\",\"qy\",\"qz\"\n\"0,5\",\"-0,25\",\"0,3\",0,0,1,0\n"
      "\"0,5\",\"0,25\",\"0,3\",0,0,1,0\n",
      "x,y,z,qw,qx,qy,qz,\n0.5,-0.25,0.3,0,0,1,0,\n0.5,0.25,0.3,0,0,1,0,\n",
      "X [mm];Y [mm];Z [mm];qw;qx;qy;qz\n500;-250;300;0;0;1;0\n500;250;300;0;0;1;0\n",
      "x(mm),y (mm),z (MM),qw,qx,qy,qz\n500,-250,300,0,0,1,0\n500,250,300,0,0,1,0\n",
  };
  for (const char* const table : tables) {
    SCOPED_TRACE(table);
    const PathProblem problem = folder.load("p.csv", table);
    ASSERT_EQ(problem.waypoints.size(), 2u);
    EXPECT_EQ(problem.waypoints[0].position, Vector3d(0.5, -0.25, 0.3));
    EXPECT_EQ(problem.waypoints[1].position, Vector3d(0.5, 0.25, 0.3));
    EXPECT_EQ(problem.waypoints[1].orientation.coeffs(), Quaterniond(0, 0, 1, 0).coeffs());
    EXPECT_FALSE(problem.roll.has_value());
    EXPECT_TRUE(problem.model->warnings.empty());
  }
}

TEST(PathTable, RefusedByLine) {
  const CamFolder folder;
  const std::string q = ",0,0,1,0\n", rows = "0.5,0,0.3" + q + "0.6,0,0.3" + q;
  const struct {
    std::string text;
    std::vector<std::string> needles;
  } cases[] = {
      {"0.5,0,0.3" + q + rows, {"p.csv:1", "no header", "x,y,z,nx,ny,nz"}},
      {"# by hand\n" + rows, {"p.csv:2", "no header"}},
      {"x,y,z\n0,0,0\n1,0,0\n", {"p.csv:1", "positions alone", "nx,ny,nz"}},
      {"x,y,z,tx,ty,tz\n", {"tangents alone"}},
      {"x,y,qw,qx,qy,qz\n", {"no column z"}},
      {"x,y,z,qw,qx,qy\n", {"no column qz"}},
      {"x,y,z,x,qw,qx,qy,qz\n", {"column x is there twice"}},
      {"x,y,z,qw,qx,qy,qz,nx,ny,nz\n", {"quaternions and normals"}},
      {"x,y,z,qw,qx,qy,qz,tx,ty,tz\n", {"quaternions and tangents"}},
      {"x,y,z,nx,ny,nz,roll_min,roll_max\n", {"roll_min,roll_max beside normals alone"}},
      {"x,y,z,qw,qx,qy,qz,colour\n", {"unknown column 'colour'", "nearest"}},
      {"sep=|\nx|y\n", {"p.csv:1", "'sep=|'", "semicolons"}},
      {"x[mm],y[mm],z[inch],qw,qx,qy,qz\n", {"column z in 'inch'", "the same"}},
      {"x[ft],y[ft],z[ft],qw,qx,qy,qz\n", {"column x in 'ft'", "m, mm or inch"}},
      {"x,y,z,qw[1],qx,qy,qz\n", {"column qw in '1'", "no unit"}},
      {"x,y,z,qw,qx,qy,qz\n0,5,0,0,0,3,0,0,0,0,1,0,0,0\n", {"14 columns", "decimal commas"}},
      {"x;y;z;qw;qx;qy;qz\n0,5;0;0.3;0;0;1;0\n", {"data row 1", "z", "'0.3'", "not both"}},
      {"x;y;z;qw;qx;qy;qz\n1.000,5;0;0;0;0;1;0\n", {"'1.000,5' is not a number"}},
      {"x;y;z;qw;qx;qy;qz\n1,000,5;0;0;0;0;1;0\n", {"'1,000,5' is not a number"}},
      {"x y z nx ny nz\n0 0 0 0 0 0\n1 0 0 0 0 1\n",
       {"p.csv:2", "data row 1", "normal has length"}},
      {"x y z nx ny nz\n0 0 0 0 0 1\n1 0 0 0 0 -3\n", {"p.csv:3", "opposite", "180"}},
      {"x y z nx ny nz tx ty tz\n0 0 0 0 0 1 0 0 0\n1 0 0 0 0 1 1 0 0\n", {"tangent has length"}},
      {"x y z nx ny nz tx ty tz\n0 0 0 0 0 1 1 0 0\n1 0 0 0 0 1 0 1e-4 1\n",
       {"data row 2", "tangent lies along the normal"}},
      {std::string("\xff\xfex\0,\0", 6), {"UTF-16", "UTF-8"}},
      {"x,y,z,qw,qx,qy,qz\n500,0,300" + q + "1001,0,3" + q, {"p.csv:3", "units: mm"}},
  };
  for (const auto& [text, needles] : cases) expect_message(folder.refusal("p.csv", text), needles);
}

TEST(PathTable, UnitsOfPositionsAndFeeds) {
  const CamFolder folder;
  const std::string head = "x,y,z,qw,qx,qy,qz,feed\n",
                    text = head + "609.6,-1,2000,1,0,0,0,30\n10,20,30,1,0,0,0,60\n";
  const Problem mm = folder.load_job("p.csv", text, ", units: mm");
  EXPECT_EQ(mm.arm().strokes[0].waypoints[0].position, Vector3d(0.6096, -0.001, 2));
  EXPECT_EQ(mm.arm().strokes[0].feed, (std::vector<double>{0.03, 0.06}));
  const Problem inch =
      folder.load_job("p.csv", head + "10,1,2,1,0,0,0,2\n1,2,3,1,0,0,0,4\n", ", units: inch");
  expect_near(inch.arm().strokes[0].waypoints[0].position, Vector3d(0.254, 0.0254, 0.0508));
  EXPECT_NEAR(inch.arm().strokes[0].feed[1], 0.1016, 1e-15);
  const Problem minute = folder.load_job(
      "p.csv",
      "feed [mm/min],x [mm],y [mm],z [mm],qw,qx,qy,qz\n600,1,2,3,1,0,0,0\n900,9,2,3,1,0,0,0\n");
  ASSERT_EQ(minute.arm().strokes[0].feed.size(), 2u);
  EXPECT_NEAR(minute.arm().strokes[0].feed[0], 0.01, 1e-16);
  EXPECT_NEAR(minute.arm().strokes[0].feed[1], 0.015, 1e-16);
  EXPECT_EQ(minute.arm().strokes[0].waypoints[0].position, Vector3d(0.001, 0.002, 0.003));
  expect_message(folder.refusal("p.csv", "x[mm],y[mm],z[mm],qw,qx,qy,qz\n", ", units: m"),
                 {"p.csv:1", "positions in mm", "`units: m`"});
  expect_message(folder.refusal("p.csv", text, ", units: cm"), {"path.units", "'cm'", "mm"});
  // metres taken for millimetres
  const std::string small = "x,y,z,qw,qx,qy,qz\n0.5,0,0.3,1,0,0,0\n0.6,0,0.3,1,0,0,0\n";
  EXPECT_TRUE(said(folder.load("p.csv", small, ", units: mm"), "are these metres?"));
  EXPECT_FALSE(said(folder.load("p.csv", small), "are these metres?"));
}

TEST(PathTable, WhatIsNotReadIsSaid) {
  const CamFolder folder;
  const PathProblem problem =
      folder.load("p.csv",
                  "time,x,y,z,qw,qx,qy,qz,feed,id\n0,0,0,0,1,0,0,0,1,first\n"
                  "1,1,0,0,1,0,0,0,1,last\n");
  EXPECT_TRUE(said(problem, "p.csv:1: not read: time, id"));
  EXPECT_TRUE(said(problem, "p.csv:1: column feed is not used"));
  EXPECT_EQ(problem.waypoints.size(), 2u);
}

TEST(PathTable, RollInDegrees) {
  const CamFolder folder;
  const PathProblem problem =
      folder.load("p.csv",
                  "x,y,z,qw,qx,qy,qz,roll_min [deg],roll_max [deg]\n0,0,0,1,0,0,0,-90,45\n"
                  "1,0,0,1,0,0,0,-45,90\n",
                  ", roll: free");
  EXPECT_NEAR(problem.waypoints[0].roll->lower, -kPi / 2, 1e-15);
  EXPECT_NEAR(problem.waypoints[1].roll->upper, kPi / 2, 1e-15);
}

/// Normals alone free the roll; the tool's z axis is against them.
TEST(PathNormals, FreeTheRoll) {
  const CamFolder folder;
  const std::string text = "x,y,z,nx,ny,nz\n0,0,0,0,0,2\n0,1,0,0,0,0.5\n0,1,1,0,1,0\n";
  const PathProblem problem = folder.load("p.csv", text);
  ASSERT_TRUE(problem.roll.has_value());
  EXPECT_TRUE(problem.roll->circle());
  EXPECT_FALSE(problem.cost.weights);
  EXPECT_TRUE(said(problem, "has the tool's axis alone"));
  expect_near(z_of(problem.waypoints[0]), {0, 0, -1});
  expect_near(x_of(problem.waypoints[0]), {0, 1, 0});  // along the path
  EXPECT_EQ(problem.waypoints[1].orientation.coeffs(), problem.waypoints[0].orientation.coeffs());
  expect_near(z_of(problem.waypoints[2]), {0, -1, 0});
  expect_near(x_of(problem.waypoints[2]), {0, 0, -1});
  EXPECT_FALSE(said(folder.load("p.csv", text, ", roll: free"), "axis alone"));
  expect_message(folder.refusal("p.csv", text, ", roll: [-1, 1]"), {"path.roll", "is a range"});
  // Columns i,j,k are the axis from tip to holder, which is outward as well.
  const PathProblem axis = folder.load("p.csv", "x y z i j k\n0 0 0 0 0 1\n0 1 0 0 0 1\n");
  EXPECT_EQ(axis.waypoints[0].orientation.coeffs(), problem.waypoints[0].orientation.coeffs());
}

Vector3d random_direction(Random& random) {
  for (;;) {
    Vector3d v;
    for (double& value : v) value = random.uniform(-1, 1);
    if (v.norm() > 0.1 && v.norm() < 1) return v.normalized();
  }
}

std::string row_of(std::initializer_list<Vector3d> vectors) {
  std::string row;
  for (const Vector3d& v : vectors)
    for (const double value : v) row += (row.empty() ? "" : ",") + std::to_string(value);
  return row + "\n";
}

/// From row to row the tool turns by the angle between its axes alone.
TEST(PathNormals, AreCarriedByTheSmallestTurns) {
  const CamFolder folder;
  Random random(swivel::test::seed("PathNormals"));
  int rows = 0;
  for (int trial = swivel::test::trials(200); trial > 0; --trial) {
    std::string text = "x,y,z,nx,ny,nz\n";
    std::vector<Vector3d> normals;
    for (int k = 0; k < 12; ++k) {
      Vector3d normal = random_direction(random);
      if (k % 2 == 1) normal = (normals.back() + 0.3 * normal).normalized();
      normals.push_back(normal);
      text += row_of({random_direction(random), 3 * normal});
    }
    const PathProblem problem = folder.load("p.csv", text);
    for (std::size_t k = 0; k < normals.size(); ++k) {
      const Waypoint& waypoint = problem.waypoints[k];
      expect_near(z_of(waypoint), -normals[k], 2e-6);  // six digits
      if (k == 0) continue;
      const Waypoint& before = problem.waypoints[k - 1];
      const double turn = before.orientation.angularDistance(waypoint.orientation),
                   axes = std::acos(std::clamp(z_of(before).dot(z_of(waypoint)), -1.0, 1.0));
      EXPECT_NEAR(turn, axes, 1e-7) << "row " << k;
      ++rows;
    }
  }
  EXPECT_GE(rows, swivel::test::trials(200) * 11);
}

/// A tangent is the tool's x axis; where the roll is free it counts as a line.
TEST(PathNormals, TangentsAndTheirSides) {
  const CamFolder folder;
  Random random(swivel::test::seed("Tangents"));
  int flips = 0;
  for (int trial = swivel::test::trials(200); trial > 0; --trial) {
    std::string text = "x,y,z,nx,ny,nz,tx,ty,tz\n";
    std::vector<Vector3d> tangents;
    Vector3d normal = random_direction(random), tangent = random_direction(random);
    while (std::abs(tangent.dot(normal)) > 0.9) tangent = random_direction(random);
    for (int k = 0; k < 10; ++k) {
      normal = (normal + 0.1 * random_direction(random)).normalized();
      tangent = (tangent + 0.1 * random_direction(random)).normalized();
      if (random.coin(0.3)) tangent = -tangent;  // as on a way back
      tangents.push_back((tangent - tangent.dot(normal) * normal).normalized());
      text += row_of({0.1 * k * Vector3d::UnitX(), normal, tangent});
    }
    const PathProblem kept = folder.load("p.csv", text),
                      free = folder.load("p.csv", text, ", roll: free");
    EXPECT_FALSE(kept.roll.has_value());
    for (std::size_t k = 0; k < tangents.size(); ++k) {
      expect_near(x_of(kept.waypoints[k]), tangents[k], 1e-5);
      const Vector3d x = x_of(free.waypoints[k]);
      EXPECT_NEAR(std::abs(x.dot(tangents[k])), 1, 1e-5);
      if (k == 0) continue;
      EXPECT_LT(free.waypoints[k - 1].orientation.angularDistance(free.waypoints[k].orientation),
                kPi / 2);
      flips += tangents[k].dot(tangents[k - 1]) < 0 ? 1 : 0;
    }
  }
  EXPECT_GE(flips, swivel::test::at_least(200));
}

/// Quaternions that flip about the free axis while it tilts turn by 180 deg about another axis.
TEST(PathNormals, HalfTurnsOfQuaternionsWithAFreeRoll) {
  const CamFolder folder;
  const std::string flat = "x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n",
                    tilted =
                        "1,0,0,0,0,0.19866933079506122,0.98006657784124163\n"
                        "2,0,0,0,0,0.19866933079506122,0.98006657784124163\n";
  const PathProblem given = folder.load("p.csv", flat + tilted),
                    free = folder.load("p.csv", flat + tilted, ", roll: free");
  for (std::size_t k = 1; k < 3; ++k) {
    const Quaterniond &a = given.waypoints[k].orientation, &b = free.waypoints[k].orientation;
    expect_near(a * Vector3d::UnitZ(), b * Vector3d::UnitZ());
    expect_near(a * Vector3d::UnitX(), -(b * Vector3d::UnitX()));
  }
  EXPECT_NEAR(free.waypoints[0].orientation.angularDistance(free.waypoints[1].orientation), 0.4,
              1e-9);
  // About the axis itself it stays as it is: such a turn has a way.
  const std::string about = "1,0,0,0,0,0,1\n";
  EXPECT_EQ(folder.load("p.csv", flat + about, ", roll: free").waypoints[1].orientation.z(), 1);
}

TEST(Apt, StatementsThatAreRead) {
  const CamFolder folder;
  const std::string text =
      "$$ CIRCLE/ in a comment\nPARTNO $ CIRCLE/1\nPPRINT GOTO/9,9,9\nUNITS/MM\nTLAXIS/0,0,1\n"
      "FROM/0,0,500\nRAPID\nGOTO/1,2,300\nRAPID\nGOTO/10,20,30 $$ here\nFEDRAT/ 600.,MMPM\n"
      "  goto / 1.5E+02 , $ aside\n +20.0,.5\nFEDRAT/MMPM,1200\nGOTO/150,20,40,1,0,1\n"
      "GOTO/150,30,40\nMULTAX/OFF\nGOTO/150,30,50\nRAPID\nGOTO/0,0,500\nFINI\n";
  const PathProblem problem = folder.load("p.apt", text);
  ASSERT_EQ(problem.waypoints.size(), 5u);
  EXPECT_EQ(problem.waypoints[0].position, Vector3d(0.01, 0.02, 0.03));
  EXPECT_EQ(problem.waypoints[1].position, Vector3d(0.15, 0.02, 0.0005));
  const Vector3d slope = Vector3d(-1, 0, -1).normalized();
  const Vector3d axes[] = {{0, 0, -1}, {0, 0, -1}, slope, slope, {0, 0, -1}};
  for (std::size_t k = 0; k < 5; ++k) expect_near(z_of(problem.waypoints[k]), axes[k]);
  EXPECT_TRUE(problem.roll && problem.roll->circle());
  EXPECT_TRUE(said(problem, "p.apt: rapid moves are left out: 2 before the cut, 1 behind it"));
  EXPECT_TRUE(said(problem, "p.apt:12: FEDRAT is not used"));
  // the feed of a move is that of the GOTO to which it leads
  EXPECT_EQ(folder.load_job("p.apt", text).arm().strokes[0].feed,
            (std::vector<double>{0.01, 0.02, 0.02, 0.02, 0.02}));
  const PathProblem skipping = folder.load(
      "p.CLS", "UNITS/MM\nCOOLNT/ON\nSPINDL/1\nSPINDL/2\nGOTO/1,2,3\nGOTO/2,2,3\nEND\n");
  EXPECT_TRUE(said(skipping, "p.CLS:2: 4 statements are not read: COOLNT, SPINDL (2), END"));
}

TEST(Apt, UnitsAndFeeds) {
  const CamFolder folder;
  const std::string moves = "GOTO/10,0,0\nFEDRAT/30\nGOTO/20,0,0\n";
  expect_message(folder.refusal("p.apt", moves), {"p.apt: has no UNITS", "units: mm"});
  EXPECT_EQ(folder.load("p.apt", moves, ", units: mm").waypoints[0].position.x(), 0.01);
  EXPECT_EQ(folder.load("p.apt", "UNITS / MM\n" + moves, ", units: mm").waypoints[1].position.x(),
            0.02);
  expect_message(folder.refusal("p.apt", "UNITS/MM\n" + moves, ", units: inch"),
                 {"p.apt:1", "UNITS in mm", "`units: inch`"});
  expect_message(folder.refusal("p.apt", "UNITS/MM\nUNITS/IN\n"), {"p.apt:2", "line 1"});
  expect_message(folder.refusal("p.apt", "UNITS/CM\n"), {"p.apt:1", "UNITS/INCHES"});
  const Stroke inch = folder.load_job("p.ncl", "UNITS/INCHES\n" + moves).arm().strokes[0];
  EXPECT_NEAR(inch.waypoints[0].position.x(), 0.254, 1e-15);
  EXPECT_NEAR(inch.feed[0], 0.0127, 1e-15);
  const Stroke mixed = folder
                           .load_job("p.cl", "UNITS/INCHES\nFEDRAT/600,MMPM\n" +
                                                 moves.substr(0, 12) + "GOTO/2,0,0\n")
                           .arm()
                           .strokes[0];
  EXPECT_EQ(mixed.feed, (std::vector<double>{0.01, 0.01}));
  // Feeds per turn of the spindle are said, and missing where other moves have one.
  const std::string per_turn = "UNITS/MM\nGOTO/0,0,0\nFEDRAT/0.2,MMPR\nGOTO/1,0,0\n";
  EXPECT_TRUE(folder.load_job("p.apt", per_turn).arm().strokes[0].feed.empty());
  EXPECT_TRUE(said(folder.load("p.apt", per_turn), "FEDRAT in MMPR"));
  expect_message(
      input_error([&] { (void)folder.load_job("p.apt", per_turn + "FEDRAT/9\nGOTO/2,0,0\n"); }),
      {"p.apt:4", "no feed"});
}

TEST(Apt, CutsBetweenRapidMoves) {
  const CamFolder folder;
  const std::string text =
      "UNITS/MM\nGOTO/0,0,9\nRAPID\nGOTO/1,0,0\nGOTO/2,0,0\nRAPID\nGOTO/2,0,9\nRAPID\n"
      "GOTO/5,0,0\nGOTO/6,0,0\nGOTO/7,0,0\nGOHOME\nGOTO/8,0,0\nGOTO/9,0,0\n";
  expect_message(folder.refusal("p.apt", text),
                 {"p.apt:9", "second of 3 cuts", "`cut: 1` to 3", "stroke"});
  const std::size_t sizes[] = {2, 3, 2};
  const double begins[] = {0.001, 0.005, 0.008};
  for (std::size_t k = 0; k < 3; ++k) {
    const PathProblem problem = folder.load("p.apt", text, ", cut: " + std::to_string(k + 1));
    EXPECT_EQ(problem.waypoints.size(), sizes[k]);
    EXPECT_EQ(problem.waypoints[0].position.x(), begins[k]);
  }
  expect_message(folder.refusal("p.apt", text, ", cut: 4"), {"p.apt", "3 cuts", "cut: 1 to 3"});
  expect_message(folder.refusal("p.apt", text, ", cut: 0"), {"path.cut", "from 1"});
  expect_message(folder.refusal("p.apt", text, ", cut: 1.5"), {"path.cut", "whole"});
  expect_message(folder.refusal("p.csv", "x,y,z,nx,ny,nz\n", ", cut: 2"), {"one cut"});
  expect_message(folder.refusal("p.apt", "UNITS/MM\nGOTO/1,2,3\nRAPID\nGOTO/2,2,3\n"),
                 {"p.apt: has no cut"});
}

TEST(Apt, StrokesTakeTheirCutsFromOneFile) {
  const ProblemFolder folder;
  std::string text = "UNITS/MM\nFEDRAT/600\n", strokes;
  for (int k = 0; k < 3; ++k) {
    const std::string x = std::to_string(k);
    text += "RAPID\nGOTO/" + x + ",0,0\nGOTO/" + x + ",1,0\n";
    strokes += "  - {name: s" + x + ", path: {file: p.apt, cut: " + std::to_string(3 - k) + "}}\n";
  }
  folder.folder().write("problems/p.apt", text);
  const Problem job = load_job(folder.folder().write(
      "problems/job.yaml",
      "robot: {urdf: ../robots/arm.urdf, base_link: base_link, tip_link: link_7}\nstrokes:\n" +
          strokes));
  ASSERT_EQ(job.arm().strokes.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(job.arm().strokes[k].waypoints[1].position,
              Vector3d(static_cast<double>(2 - k) / 1000, 0.001, 0));
    EXPECT_EQ(job.arm().strokes[k].feed.size(), 2u);
  }
  EXPECT_EQ(job.arm().model->warnings.size(), 1u);
  EXPECT_TRUE(job.arm().roll && job.arm().roll->circle());
}

TEST(Apt, RefusedByLine) {
  const CamFolder folder;
  const std::string go = "UNITS/MM\nGOTO/1,2,3\n";
  const struct {
    std::string text;
    std::vector<std::string> needles;
  } cases[] = {
      {go + "GOTO/2,2\n", {"p.apt:3", "2 values", "x,y,z,i,j,k"}},
      {go + "GOTO/2,2,3,0,0\n", {"p.apt:3", "5 values"}},
      {go + "GOTO/2,2,P1\n", {"p.apt:3", "'P1' is not a number"}},
      {go + "GOTO/2,2,nan\n", {"'NAN' is not a number"}},
      {go + "CIRCLE/1,2,3,0,0,1,5\n", {"p.apt:3", "CIRCLE", "short lines"}},
      {go + "CYCLE/DRILL,5\n", {"p.apt:3", "CYCLE"}},
      {go + "CUTCOM/LEFT\n", {"p.apt:3", "CUTCOM", "tip"}},
      {go + "GODLTA/0,0,1\n", {"p.apt:3", "GODLTA"}},
      {go + "ROTABL/90\n", {"p.apt:3", "ROTABL"}},
      {go + "ORIGIN/0,0,1\n", {"p.apt:3", "ORIGIN"}},
      {go + "GOTO/2,2,3,0,0,-1\n", {"p.apt:3: tool axis", "opposite"}},
      {go + "GOTO/2,2,3,0,0,0\n", {"p.apt:3: tool axis", "length 0"}},
      {go + "GOTO/2,2,3\nFINI\nGOTO/3,2,3\n", {"p.apt:5", "after FINI"}},
      {go + "GOTO/2,2,3,$\n", {"p.apt:3", "ends with $"}},
      {go + std::string("\0GOTO", 5), {"p.apt", "binary"}},
      {go + "GOTO/1000001,2,3\n", {"p.apt:3", "too large"}},
      {"", {"p.apt", "has no cut"}},
  };
  for (const auto& [text, needles] : cases)
    expect_message(folder.refusal("p.apt", text, text.empty() ? ", units: mm" : ""), needles);
  // Where these statements say nothing they are skipped.
  EXPECT_EQ(folder
                .load("p.apt", go + "CUTCOM/OFF\nCYCLE/OFF\nORIGIN/0,0,0\nTRACUT/NOMORE\n"
                                    "GOTO/2,2,3\n")
                .waypoints.size(),
            2u);
}

}  // namespace
}  // namespace swivel::io::test
