#include <complex>

#include "ui/sound/faded_noise.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::ui;

namespace {

using Complex = std::complex<double>;

/// Cooley and Tukey's, in place. @pre a power of two
void fourier(std::vector<Complex>& x) {
    const std::size_t n = x.size();
    for (std::size_t i = 1, j = 0; i < n; ++i) {
        std::size_t bit = n >> 1U;
        for (; (j & bit) != 0; bit >>= 1U) {
            j ^= bit;
        }
        j ^= bit;
        if (i < j) {
            std::swap(x[i], x[j]);
        }
    }
    for (std::size_t length = 2; length <= n; length *= 2) {
        const Complex root = std::polar(1.0, -2.0 * M_PI / static_cast<double>(length));
        for (std::size_t i = 0; i < n; i += length) {
            Complex w = 1.0;
            for (std::size_t k = 0; k < length / 2; ++k, w *= root) {
                const Complex even = x[i + k];
                const Complex odd = w * x[i + k + length / 2];
                x[i + k] = even + odd;
                x[i + k + length / 2] = even - odd;
            }
        }
    }
}

/// Mean power of each bin over `pieces` pieces of `n` samples (Welch 1967, Hann's window, no
/// overlap).
template <class Next>
std::vector<double> spectrum(Next&& next, std::size_t n, int pieces) {
    std::vector<double> power(n / 2, 0.0);
    std::vector<Complex> piece(n);
    for (int p = 0; p < pieces; ++p) {
        for (std::size_t i = 0; i < n; ++i) {
            const double hann =
                0.5 - 0.5 * std::cos(2.0 * M_PI * static_cast<double>(i) / static_cast<double>(n));
            piece[i] = hann * next();
        }
        fourier(piece);
        for (std::size_t k = 0; k < n / 2; ++k) {
            power[k] += std::norm(piece[k]);
        }
    }
    return power;
}

struct Band {
    double octave = 0.0;  ///< log2 of its middle over 1 kHz
    double level = 0.0;   ///< dB, of power per hertz against 1/f: 0 for pink noise
};

/// Thirds of octaves from 50 Hz to 10 kHz, their mean level made 0.
std::vector<Band> thirds(const std::vector<double>& power, double hz_per_bin) {
    std::vector<Band> bands;
    double mean = 0.0;
    for (int third = -13; third <= 10; ++third) {  // 49.6 Hz ... 10.08 kHz
        const double middle = 1000.0 * std::pow(2.0, third / 3.0);
        double found = 0.0;
        double pink = 0.0;
        for (std::size_t k = 1; k < power.size(); ++k) {
            const double f = hz_per_bin * static_cast<double>(k);
            if (f >= middle * std::pow(2.0, -1.0 / 6.0) && f < middle * std::pow(2.0, 1.0 / 6.0)) {
                found += power[k];
                pink += 1.0 / f;
            }
        }
        bands.push_back({third / 3.0, 10.0 * std::log10(found / pink)});
        mean += bands.back().level;
    }
    for (Band& band : bands) {
        band.level -= mean / static_cast<double>(bands.size());
    }
    return bands;
}

/// dB an octave by least squares, 0 for pink noise.
double tilt(const std::vector<Band>& bands) {
    double xy = 0.0;
    double xx = 0.0;
    double x_mean = 0.0;
    for (const Band& band : bands) {
        x_mean += band.octave / static_cast<double>(bands.size());
    }
    for (const Band& band : bands) {
        xy += (band.octave - x_mean) * band.level;
        xx += (band.octave - x_mean) * (band.octave - x_mean);
    }
    return xy / xx;
}

constexpr std::size_t kPiece = 32768;
constexpr int kPieces = 48;  // the 50 Hz third has a standard deviation of about 0.27 dB then

}  // namespace

TEST_CASE("pink noise loses 3 dB an octave within 1 dB from 50 Hz to 10 kHz, at every rate") {
    EACH(rate, 44100.0, 48000.0, 96000.0);
    PinkNoise noise(Pcg32(20260114, 7), rate);
    const auto bands = thirds(spectrum([&] { return noise.next(); }, kPiece, kPieces),
                              rate / static_cast<double>(kPiece));
    for (const Band& band : bands) {
        CAPTURE(1000.0 * std::pow(2.0, band.octave), band.level);
        CHECK(std::fabs(band.level) <= 1.0);
    }
    CHECK(std::fabs(tilt(bands)) <= 0.06);
}

TEST_CASE("the spectrum test tells pink noise from white and from brown") {
    Pcg32 random(1, 2);
    const auto white = [&] {
        return static_cast<double>(random.next()) / 2147483648.0 - 1.0;
    };
    CHECK(tilt(thirds(spectrum(white, kPiece, 8), 48000.0 / kPiece)) > 2.8);
    double sum = 0.0;
    const auto brown = [&] {
        return sum = 0.9999 * sum + white();
    };
    CHECK(tilt(thirds(spectrum(brown, kPiece, 8), 48000.0 / kPiece)) < -2.5);
}

TEST_CASE("pink noise has mean square 1 and nearly Gaussian peaks, one seed one noise") {
    SEED(3ULL);
    PinkNoise noise(Pcg32(seed, 3), 48000.0);
    PinkNoise same(Pcg32(seed, 3), 48000.0);
    PinkNoise other(Pcg32(seed + 100, 3), 48000.0);
    constexpr int kSamples = 40 * 48000;
    double square = 0.0;
    double product = 0.0;
    int beyond = 0;
    bool equal = true;
    for (int i = 0; i < kSamples; ++i) {
        const double x = noise.next();
        equal = equal && x == same.next();
        square += x * x;
        product += x * other.next();
        beyond += std::fabs(x) > 4.0 ? 1 : 0;
    }
    CHECK(equal);
    CHECK(std::fabs(square / kSamples - 1.0) < 0.06);
    CHECK(std::fabs(product / kSamples) < 0.06);
    CHECK(beyond < kSamples / 8000);  // Gauss: 1 in 15787
}

TEST_CASE("noise comes in and goes out along t^2 (3 - 2 t) and is silent before and after") {
    constexpr double kRate = 48000.0;
    const double level = GENERATE(-60.0, -30.0, -12.0);
    FadedNoise faded(Pcg32(5, 9), kRate, level);
    PinkNoise plain(Pcg32(5, 9), kRate);
    const double amplitude = std::pow(10.0, level / 20.0);
    std::vector<float> block(480);
    double t = 0.0;  // of the fade, by hand
    double worst = 0.0;
    const auto run = [&](int blocks, double direction) {
        for (int i = 0; i < blocks; ++i) {
            faded.render(block);
            for (const float sample : block) {
                t = std::clamp(t + direction / (0.25 * kRate), 0.0, 1.0);
                const double wanted = amplitude * t * t * (3.0 - 2.0 * t) * plain.next();
                worst = std::max(
                    worst, std::fabs(static_cast<double>(sample) - std::clamp(wanted, -1.0, 1.0)));
            }
        }
    };
    run(10, -1.0);
    CHECK((faded.silent() && !faded.full()));
    CHECK(std::all_of(block.begin(), block.end(), [](float x) { return x == 0.0F; }));
    faded.on();
    run(24, 1.0);
    CHECK((!faded.full() && !faded.silent()));
    run(2, 1.0);
    CHECK(faded.full());
    run(100, 1.0);
    CHECK(faded.full_s() == Approx(1.01).margin(0.011));
    faded.off();
    run(26, -1.0);
    CHECK(faded.silent());
    CHECK(std::all_of(block.begin(), block.end(), [](float x) { return x == 0.0F; }));
    CHECK(worst < 1e-7);
}

TEST_CASE("noise is as loud as its level says and never beyond full scale") {
    const double level = GENERATE(-60.0, -30.0, -12.0, 0.0);
    FadedNoise faded(Pcg32(11, 4), 48000.0, level);
    faded.on();
    std::vector<float> block(48000);
    faded.render(block);
    double square = 0.0;
    bool inside = true;
    constexpr int kSeconds = 20;
    for (int s = 0; s < kSeconds; ++s) {
        faded.render(block);
        for (const float x : block) {
            square += static_cast<double>(x) * static_cast<double>(x);
            inside = inside && std::fabs(x) <= 1.0F;
        }
    }
    CHECK(inside);
    if (level <= -12.0) {
        CHECK(std::fabs(10.0 * std::log10(square / (kSeconds * 48000.0)) - level) < 0.4);
    }
}

TEST_CASE("noise at a rate that no sound device has is refused") {
    for (const double rate : {0.0, 15999.0, 192001.0, std::nan("")}) {
        CHECK_THROWS_AS(PinkNoise(Pcg32(1, 1), rate), std::invalid_argument);
    }
}
