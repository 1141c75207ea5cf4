// SPDX-License-Identifier: LGPL-2.1-or-later
// Writes the sound of the bundled clip, a quiet plucked melody: melody OUT.wav SECONDS
//
// Mono, 48 kHz, 16-bit PCM. The strings are Karplus-Strong delay lines (Computer Music Journal
// 7(2), 1983): a burst of noise that circulates through a two-point average.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>
#include <vector>

namespace {

constexpr int kRate = 48000;
constexpr double kBeat = 0.25;    // seconds
constexpr double kTail = 0.6;     // seconds of fading at the end
constexpr double kPeak = 0.18;    // of full scale
constexpr double kDecay = 0.999;  // per period; the average in the loop does the rest

// Semitones from A3, one per beat; kRest is silence.
constexpr int kRest = -100;
constexpr int kTune[] = {0,  7,  12, 16, 14, 12,    7, kRest, 5,  9,
                         12, 17, 16, 12, 9,  kRest, 0, 7,     12, 16};
constexpr int kBass[] = {-12,   kRest, kRest, kRest, -5,    kRest, kRest, kRest, -7,    kRest,
                         kRest, kRest, -5,    kRest, kRest, kRest, -12,   kRest, kRest, kRest};

void pluck(std::vector<double>& sound, double start, int semitone, double loudness,
           std::mt19937& random) {
  if (semitone == kRest) return;
  double frequency = 220 * std::exp2(semitone / 12.0);
  std::vector<double> line(static_cast<size_t>(std::lround(kRate / frequency - 0.5)));
  for (double& v : line)
    v = loudness * (static_cast<double>(random()) / std::mt19937::max() * 2 - 1);
  // A dark attack: the burst is smoothed before it circulates.
  for (int pass = 0; pass < 6; ++pass) {
    for (size_t i = 0; i < line.size(); ++i) line[i] = (line[i] + line[(i + 1) % line.size()]) / 2;
  }
  size_t at = 0;
  for (auto i = static_cast<size_t>(start * kRate); i < sound.size(); ++i) {
    size_t next = (at + 1) % line.size();
    sound[i] += line[at];
    line[at] = kDecay * (line[at] + line[next]) / 2;
    at = next;
  }
}

std::vector<int16_t> render(double seconds) {
  std::vector<double> sound(static_cast<size_t>(seconds * kRate), 0);
  std::mt19937 random(7);
  double start = 0.05;
  for (size_t i = 0; i < std::size(kTune); ++i, start += kBeat) {
    pluck(sound, start, kTune[i], 1, random);
    pluck(sound, start, kBass[i], 1.2, random);
  }
  double loudest = 0;
  for (double v : sound) loudest = std::max(loudest, std::fabs(v));
  std::vector<int16_t> samples;
  for (size_t i = 0; i < sound.size(); ++i) {
    double left = static_cast<double>(sound.size() - i) / (kTail * kRate);
    double fade = left < 1 ? 0.5 - 0.5 * std::cos(3.14159265358979 * left) : 1;
    samples.push_back(static_cast<int16_t>(std::lround(sound[i] / loudest * kPeak * fade * 32767)));
  }
  return samples;
}

void append(std::string& file, uint32_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) file.push_back(static_cast<char>(value >> (8 * i)));
}

std::string wav(const std::vector<int16_t>& samples) {
  auto size = static_cast<uint32_t>(samples.size() * 2);
  std::string file = "RIFF";
  append(file, 36 + size, 4);
  file += "WAVEfmt ";
  append(file, 16, 4);         // size of the format chunk
  append(file, 1, 2);          // PCM
  append(file, 1, 2);          // channels
  append(file, kRate, 4);      // frames per second
  append(file, kRate * 2, 4);  // bytes per second
  append(file, 2, 2);          // bytes per frame
  append(file, 16, 2);         // bits per sample
  file += "data";
  append(file, size, 4);
  for (int16_t sample : samples) append(file, static_cast<uint16_t>(sample), 2);
  return file;
}

}  // namespace

int main(int argc, char** argv) {
  double seconds = argc == 3 ? std::atof(argv[2]) : 0;
  if (!(seconds > 0 && seconds < 3600)) {
    std::fprintf(stderr, "usage: melody OUT.wav SECONDS\n");
    return EXIT_FAILURE;
  }
  std::string file = wav(render(seconds));
  std::ofstream out(argv[1], std::ios::binary);
  out << file;
  out.close();
  if (!out) {
    std::fprintf(stderr, "melody: cannot write %s\n", argv[1]);
    return EXIT_FAILURE;
  }
}
