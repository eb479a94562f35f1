// The generated rooms that tests fly through, by what they have. The number is the generator's seed, from
// which follow room, flight and noise; tests of the generator itself take any.
#pragma once
#include <array>
#include <cstdint>

namespace rosefusion::testing {

/// 4.6 x 5.3 m, two windows that face each other: for tests that need a room, whichever.
constexpr std::uint64_t kAnyRoom = 5;

/// 5.5 x 4.3 m: nothing but furniture and pictures tells its four walls apart.
constexpr std::uint64_t kRoomWithoutWindows = 7;

/// 4.8 x 5.0 m and 4.4 x 4.5 m, two windows each: fit neither each other nor the room without windows.
constexpr std::uint64_t kUnlikeRoom = 9, kThirdRoom = 10;

/// 6.6 x 5.3 m: the flight is at the other end after 105 frames, and back where it began after 195.
constexpr std::uint64_t kRoomFlownThereAndBack = 31;

/// 5.1 x 4.6 m, two windows that face each other: the flight's first frames show enough to be found again by.
constexpr std::uint64_t kRoomSeenAgain = 904;

/// 4.7 x 3.8 m without windows and 4.5 x 3.7 m with one: nothing of the second fits into the first, or into
/// the one above.
constexpr std::uint64_t kSmallRoom = 905, kForeignRoom = 906;

/// 6.8 x 4.8 m, one window: the flight goes more than half a metre in ten frames.
constexpr std::uint64_t kRoomFlownFast = 907;

/// 6.9 x 4.7 m: frame 201 is 1.5 m from all of the first 120, which show less than half of its view.
constexpr std::uint64_t kRoomWithFarEnd = 911;

/// 6.2 x 3.9 m: after ten dark frames from the 120th on, half of the view is still known.
constexpr std::uint64_t kRoomCrossedInTheDark = 961;

/// 4.1 x 3.8 m, windows in three walls: 22 cm beside its place a wall fits the pane of the window next to it.
constexpr std::uint64_t kRoomWithPaneLikeWall = 1007;

/// Of 17 to 34 m2, with windows in two or three walls, and 1.2 m from the flight's start there is space for a
/// camera.
constexpr std::array<std::uint64_t, 3> kRoomsToLookAroundIn{921, 922, 923};

/// 4.6 x 4.8 m, one window: turned by 0.25 rad from the flight's start most of the view is known, by 0.65 rad
/// little.
constexpr std::uint64_t kRoomToTurnIn = 924;

/// Of 17 to 32 m2, with one to three windows. They were in no experiment.
constexpr std::array<std::uint64_t, 3> kRoomsOfDefaultPreset{901, 902, 903},
    kRoomsOfPaperPreset{941, 942, 943};

}  // namespace rosefusion::testing
