#pragma once

#include <array>
#include <string_view>

/// Runs of QUEST+ stimulus by stimulus: the examples of A. B. Watson, "QUEST+", Journal of Vision
/// 17(3):10 (2017), as tabulated in the tests of the program questplus by R. Hoechenberger. '1' is
/// correct.
namespace palpate::tests {

// clang-format off
/// "Estimation of contrast threshold {1, 1, 2}": dB stimuli and thresholds -40..0, slope 3.5, guess
/// .5, lapse .02. Mode of the threshold at the end: -20 dB.
inline constexpr std::array<int, 32> kThresholdStimuli{
    -18, -22, -25, -28, -30, -22, -13, -15, -16, -18, -19, -20, -21, -22, -23, -19, -20, -20, -18, -18,
    -19, -17, -17, -18, -18, -18, -19, -19, -19, -19, -19, -19};
inline constexpr std::string_view kThresholdAnswers = "11110011111111011011011111111111";

/// The section "Implementation": slopes 2..5 as well. Mode: -20 dB, 3.
inline constexpr std::array<int, 64> kSlopeStimuli{
    -18, -22, -12, -13, -15, -16, -17, -18, -19, -21, -24, -25, -26, -27, -21, -22, -23, -20, -20, -20,
    -21, -19, -19, -20, -20, -20, -19, -19, -19, -19, -19, -20, -20, -20, -20, -20, -21, -21, -20, -20,
    -20, -19, -18, -18, -19, -19, -19, -18, -18, -17, -18, -18, -18, -17, -17, -17, -17, -17, -17, -17,
    -18, -18, -18, -18};
inline constexpr std::string_view kSlopeAnswers =
    "1011111111111011011101111011111111111011001111010111011111111111";

/// "Estimation of contrast threshold, slope, and lapse {1, 3, 2}": slopes 2..5, lapses 0, .01, ..,
/// .04. Mode: -20 dB, 5, .04.
inline constexpr std::array<int, 128> kLapseStimuli{
    -18, -22, -25, -28, -30, -21, -12, -14, -15, -16, -18, -19, -20, -22, -23, -18, -19, -16, -17, -17,
    -18, -18, -18, -19, -19, -17, -17, -18, -18, -18, -18, -19, -19, -20, -18, -18, -18, -18, -18, -19,
    -19, -19, -19, -20, -18, -18, -18, -18, -18, -18, -18, -18, -18, -19, -19, -19, -20, -18, -18, -18,
    -18, -19, -19, -19, -18, -18, -18, -18, -19, -19, -19, -19, -19, -19, -19, -19, -20, -21, -19, -19,
    -19, -19, -19, -19, -19, -18, -19, -19, -16, -16, -16, -16, -16, -16, 0, 0, -19, -19, -19, -19,
    -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -21, -21, -19, -19, -19, -19, -19, -19, -19, -19,
    -19, -19, -19, -19, -19, -19, -19, -19};
inline constexpr std::string_view kLapseAnswers =
    "1111001111111101011111110111111110111111111011101111111101111110"
    "1111111111111010111101101111111011111111111111101110100111101111";

/// "Estimation of mean, standard deviation, and lapse {1, 3, 2}": cumulative normal with the
/// two-sided lapse, stimuli -10..10, means -5..5, standard deviations 1..10, lapses 0, .01, ..,
/// .04. Mode: 0, 4, .01.
inline constexpr std::array<int, 128> kNormalStimuli{
    0, -1, 2, -2, 2, 3, 3, -5, 3, 3, 3, 3, -7, -7, -7, -7, 4, -7, 4, 4, 4, -8, -8, -8, 4, -8, 4, -8, -7,
    4, -7, -7, 4, -7, 4, -7, -6, 3, -4, -5, 3, 3, -7, 2, 2, 1, 0, -7, -6, -6, -6, 2, -5, 2, -6, -5, 3,
    -5, -5, 3, 4, -5, -5, 4, -4, -4, -4, -4, 4, 3, 3, 4, 5, 5, -5, 5, -5, -5, 4, 5, 5, -5, -4, -4, -4,
    -4, 5, -4, -4, -3, 4, 4, 5, 5, -4, 5, -4, -4, 5, 4, 5, 5, -5, 5, -4, -4, -4, -4, 5, -4, 5, 4, -4, 4,
    -4, -4, -4, 4, -4, -4, -4, 4, 4, -4, 4, 4, 4, -4};
inline constexpr std::string_view kNormalAnswers =
    "1001111111010000110110001010010010100101110111000001000010001001"
    "0001110011010001100000100110110101101101000011110100010000111110";

/// "Contrast sensitivity function {2, 3, 2}": threshold max(t, c0 + cf f) dB at the spatial
/// frequency f; contrasts -50, -48, .., 0 dB, frequencies 0, 2, .., 40, t -50, -48, .., -30, c0
/// -60, -58, .., -40, cf .8, 1, .., 1.6, slope 3, guess .5, lapse .01. Mode: -32, -56, 1.4.
inline constexpr std::array<int, 32> kCsfContrasts{
    0, -4, 0, 0, -38, 0, -40, 0, -26, -26, 0, -36, -36, 0, -26, -26, -2, -26, -6, -26, 0, -26, 0, -26,
    -32, -32, -34, -34, 0, -26, 0, -26};
inline constexpr std::array<int, 32> kCsfFrequencies{
    40, 40, 34, 36, 0, 38, 0, 38, 18, 18, 40, 0, 0, 40, 20, 20, 40, 22, 40, 20, 40, 18, 40, 18,
    0, 0, 0, 0, 40, 18, 38, 18};
inline constexpr std::string_view kCsfAnswers = "10111101111101111100111111100111";
// clang-format on

}  // namespace palpate::tests
