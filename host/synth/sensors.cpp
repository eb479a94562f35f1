#include "host/synth/sensors.h"

#include <algorithm>

#include "host/core/error.h"

namespace rosefusion {
namespace {

constexpr Intrinsics centred(int width, int height, double focal) {
  return {width, height, focal, focal, (width - 1) / 2.0, (height - 1) / 2.0};
}

Sensor kinect2() {
  Sensor s{"kinect2", DepthPrinciple::TimeOfFlight, centred(512, 424, 365.5), 0.5, 8, 30};
  s.exposure = 0.02;
  s.modulation_hz = 80e6;
  s.signal = 90000;  // depths err as Fankhauser et al. 2015 measured: 1.3, 1.7 and 4.3 mm at 1, 2 and 4 m
  s.colour = centred(960, 540, 535);  // half of 1920 x 1080
  s.colour_at_x = -0.052;
  return s;
}

/// The narrow field of view, unbinned.
Sensor azure() {
  Sensor s{"azure", DepthPrinciple::TimeOfFlight, centred(640, 576, 504), 0.5, 3.86, 30};
  s.exposure = 0.0128;
  s.modulation_hz = 200e6;
  s.signal = 20000;  // 1.0, 2.1 and 4.3 mm at 1, 2 and 3.5 m, within its maker's 17 mm
  s.field = FieldOfView::Hexagon;
  s.colour = centred(1280, 720, 606);
  s.colour_at_x = -0.032;
  return s;
}

Sensor d400() {
  Sensor s{"d400", DepthPrinciple::Stereo, centred(640, 480, 385), 0.16, 10, 30};
  s.baseline = 0.05;
  s.registration = Registration::Areas;
  s.colour = centred(640, 480, 615);
  s.colour_at_x = -0.015;
  return s;
}

Sensor l515() {
  Sensor s{"l515", DepthPrinciple::TimeOfFlight, centred(640, 480, 460), 0.25, 9, 30};
  s.exposure = 0.03;
  s.row_by_row = true;
  s.modulation_hz = 100e6;
  s.signal = 12000;
  s.colour = centred(960, 540, 680);  // half of 1920 x 1080
  s.colour_at_x = 0.014;
  return s;
}

Sensor f200() {
  Sensor s{"f200", DepthPrinciple::StructuredLight, centred(640, 480, 475), 0.13, 1.9, 30};
  s.baseline = 0.047;
  s.registration = Registration::Points;
  s.colour = centred(640, 480, 615.2);
  s.colour_at_x = 0.0257;
  return s;
}

Sensor iphone() {
  Sensor s{"iphone", DepthPrinciple::PhoneLidar, centred(256, 192, 212), 0.15, 5, 60};
  return s;
}

}  // namespace

Pose Sensor::outputFromDepth() const {
  Pose pose = Pose::Identity();
  if (registration != Registration::None) pose.translation().x() = -colour_at_x;
  return pose;
}

const std::vector<Sensor>& sensors() {
  static const std::vector<Sensor> all{Sensor{}, kinect2(), azure(), d400(), l515(), f200(), iphone()};
  return all;
}

const Sensor& sensorNamed(const std::string& name) {
  std::string known;
  for (const Sensor& s : sensors()) {
    if (s.name == name) return s;
    known += (known.empty() ? "" : ", ") + s.name;
  }
  throw InputError("--sensor: there is no sensor '" + name + "'; known are " + known + ".");
}

const char* toString(Registration registration) {
  switch (registration) {
    case Registration::Points:
      return "points";
    case Registration::Areas:
      return "areas";
    case Registration::None:
      break;
  }
  return "none";
}

Registration registrationFrom(const std::string& word) {
  for (const Registration r : {Registration::None, Registration::Points, Registration::Areas})
    if (word == toString(r)) return r;
  throw InputError("--registered: there is no '" + word + "'; give points, areas or none.");
}

}  // namespace rosefusion
