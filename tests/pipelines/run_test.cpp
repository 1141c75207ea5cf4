// SPDX-License-Identifier: LGPL-2.1-or-later
// ./dev run: output files without a display, the window with one, and error messages.
#include <fstream>

#include "pipeline_test.hpp"

namespace inverse::testing {
namespace {

class Run : public PipelineTest {
 protected:
  int run_it(std::vector<std::string> words, const Process::Environment& more = {}) {
    words.insert(words.begin(), {"--out", file("out")});
    auto all = more;
    all["INVERSE_RUN"] = INVERSE_RUN;
    return run("run", words, all, 240);
  }
  void expect_complaint(const std::string& input, const std::string& text) {
    EXPECT_EQ(run_it({input}), 1) << input;
    expect_contains(output_, text);
    EXPECT_FALSE(std::filesystem::exists(file("out/decomposition.mkv"))) << input;
  }
  /// A file of so many small frames of a pattern.
  std::string clip(int frames, const std::string& pattern = "smpte") {
    make_media(file("in.mkv"),
               "videotestsrc num-buffers=" + std::to_string(frames) + " pattern=" + pattern +
                   " ! video/x-raw,width=160,height=120,framerate=10/1 ! vp8enc deadline=1 ! "
                   "matroskamux");
    return file("in.mkv");
  }
};

TEST_F(Run, BundledClipWithoutDisplay) {
  ASSERT_EQ(run_it({"--seconds", "0.6"}), 0) << output_;
  expect_contains(output_, "frames/s");

  const Media movie = read_media(file("out/decomposition.mkv"));
  ASSERT_NO_FATAL_FAILURE(expect_video(movie, 1280, 960, 15));
  EXPECT_EQ(movie.frames.size(), 15u);
  const Image& frame = movie.frames.back();
  expect_mosaic(frame);
  // The recolored view is the input but for the recolored parts.
  EXPECT_GT(frame.variance(.5, .5, 1, 1), 100);
  // The original sound, up to the stop.
  ASSERT_EQ(movie.sounds.size(), 1u);
  std::filesystem::path clip;
  for (const auto& entry : std::filesystem::directory_iterator(MEDIA))
    if (entry.path().stem() == "clip") clip = entry.path();
  const Media whole = read_media(clip);
  ASSERT_EQ(whole.sounds.size(), 1u);
  ASSERT_GT(movie.sounds[0].packets.size(), 3u);
  ASSERT_LE(movie.sounds[0].packets.size(), whole.sounds[0].packets.size());
  for (size_t i = 0; i < movie.sounds[0].packets.size(); ++i)
    EXPECT_EQ(movie.sounds[0].packets[i], whole.sounds[0].packets[i]) << "packet " << i;

  const Media sheet = read_media(file("out/contact-sheet.png"));
  ASSERT_EQ(sheet.frames.size(), 1u);
  const Image& png = sheet.frames[0];
  EXPECT_EQ(png.width, 2 * 640 + 3 * 8);
  EXPECT_EQ(png.height, 3 * 480 + 4 * 8);
  // Each of the six tiles shows something.
  for (int i = 0; i < 6; ++i) {
    const double left = (i % 2) / 2.0, top = (i / 2) / 3.0;
    EXPECT_GT(png.variance(left + .02, top + .02, left + .48, top + .31), 300) << "tile " << i;
  }
}

TEST_F(Run, RepaintsAColorThatStandsOut) {
  make_media(
      file("in.mkv"),
      "videotestsrc num-buffers=8 pattern=gradient ! "
      "video/x-raw,format=AYUV,width=120,height=120,framerate=10/1 ! videobox right=-40 fill=red ! "
      "videoconvert ! vp8enc deadline=1 end-usage=cq cq-level=4 ! matroskamux");
  ASSERT_EQ(run_it({file("in.mkv")}), 0) << output_;
  expect_contains(output_, "painting what is red (2");
  const Media movie = read_media(file("out/decomposition.mkv"));
  ASSERT_EQ(movie.frames.size(), 8u);
  for (const Image& frame : movie.frames) {  // from the first one on
    EXPECT_GT(frame.mean(0, .4, .1, .48, .4), frame.mean(2, .4, .1, .48, .4) + 100);
    EXPECT_GT(frame.mean(2, .9, .6, .98, .9), frame.mean(0, .9, .6, .98, .9) + 100);
    // What is gray stays gray.
    EXPECT_NEAR(frame.mean(2, .55, .6, .8, .9), frame.mean(0, .55, .6, .8, .9), 4);
  }
}

TEST_F(Run, PaintsEverySurfaceWhereNoColorStandsOut) {
  ASSERT_EQ(run_it({clip(8, "gradient")}), 0) << output_;
  expect_contains(output_, "no color stands out");
  const Media movie = read_media(file("out/decomposition.mkv"));
  ASSERT_EQ(movie.frames.size(), 8u);
  const Image& frame = movie.frames.back();
  EXPECT_NEAR(frame.mean(0, .1, .1, .4, .4), frame.mean(2, .1, .1, .4, .4), 4);
  EXPECT_GT(frame.mean(0, .6, .6, .9, .9), frame.mean(2, .6, .6, .9, .9) + 15);
}

TEST_F(Run, ElementsTakeThePlaceOfTheChain) {
  ASSERT_EQ(run_it({clip(30), "--", "intrinsicdecomp", "light-color-slope=0", "show=shading", "!",
                    "videoconvert"}),
            0)
      << output_;
  const Media movie = read_media(file("out/decomposition.mkv"));
  ASSERT_EQ(movie.frames.size(), 30u);
  const Image& frame = movie.frames.back();
  EXPECT_EQ(frame.width, 160);
  EXPECT_EQ(frame.height, 120);
  EXPECT_NEAR(frame.mean(0), frame.mean(1), 2);
  EXPECT_NEAR(frame.mean(2), frame.mean(1), 2);
  EXPECT_GT(std::filesystem::file_size(file("out/contact-sheet.png")), 1000u);
}

TEST_F(Run, InterruptEndsTheFilesProperly) {
  Process process({script("run"), "--out", file("out")},
                  environment({{"INVERSE_RUN", INVERSE_RUN}}));
  for (int i = 0; i < 600 && process.output().find("frame ") == std::string::npos; ++i)
    ASSERT_EQ(process.wait(0.1), -1) << process.output();
  process.interrupt();
  ASSERT_EQ(process.wait(60), 0) << process.output();
  const Media movie = read_media(file("out/decomposition.mkv"));
  ASSERT_NO_FATAL_FAILURE(expect_video(movie, 1280, 960, 3));
  EXPECT_TRUE(std::filesystem::exists(file("out/contact-sheet.png")));
}

TEST_F(Run, UnreadableInputsAreErrors) {
  expect_complaint(file("none.mp4"), "there is no file");
  expect_complaint("/dev/video97", "there is no camera /dev/video97");
  expect_complaint("nosuch://place", "nothing installed here opens \"nosuch://\"");
  expect_complaint("file:///no/such/file.mp4", "cannot read file:///no/such/file.mp4");
  expect_complaint(file(""), "is a folder");
  std::ofstream(file("empty.mp4")).flush();
  expect_complaint(file("empty.mp4"), "is empty");
  std::ofstream(file("text.mp4")) << "this is no video";
  expect_complaint(file("text.mp4"), "cannot play");
  make_media(file("sound.mkv"), "audiotestsrc num-buffers=20 ! vorbisenc ! matroskamux");
  expect_complaint(file("sound.mkv"), "no video in");
}

TEST_F(Run, NothingIsReplacedUnasked) {
  const std::string in = clip(5), movie = file("out/decomposition.mkv");
  const auto size = [&] { return std::filesystem::file_size(movie); };
  ASSERT_EQ(run_it({in, "--", "identity"}), 0) << output_;
  const auto before = size();
  EXPECT_EQ(run_it({in, "--", "identity"}), 1);
  expect_contains(output_, "give --overwrite to replace it");
  EXPECT_EQ(run_it({"--overwrite", movie, "--", "identity"}), 1);
  expect_contains(output_, "would replace the input");
  EXPECT_EQ(run_it({"--overwrite", in, "--", "nosuchelement"}), 1);
  EXPECT_EQ(size(), before);
  ASSERT_EQ(run_it({"--overwrite", clip(9), "--", "identity"}), 0) << output_;
  EXPECT_EQ(read_media(movie).frames.size(), 9u);
  // Nothing else is left there.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file("out")), {}), 2);
}

TEST_F(Run, AListWithinAFileIsNotOpened) {
  for (const std::string& head : {std::string(), std::string("ID3\4\0\0\0\0\0\0", 10)}) {
    std::ofstream(file("list.mp4"), std::ios::binary)
        << head << "#EXTM3U\n#EXT-X-TARGETDURATION:2\n#EXTINF:2,\nhttp://127.0.0.1:9/a.ts\n";
    expect_complaint(file("list.mp4"), "it is a list of streams");
  }
}

TEST_F(Run, ElementsThatDoNotFitAreErrors) {
  const std::string in = clip(5);
  for (const auto& [elements, text] :
       {std::pair{"nosuchelement", "no element \"nosuchelement\""},
        {"intrinsicdecomp ! fakesink", "must take video at its beginning"},
        {"intrinsicrecolor ! intrinsiccompose", "insert intrinsicdecomp"}}) {
    EXPECT_EQ(run_it({in, "--", elements}), 1);
    expect_contains(output_, text);
  }
}

TEST_F(Run, WindowWhereThereIsADisplay) {
  if (system("command -v Xvfb >/dev/null") != 0) GTEST_SKIP() << "Xvfb is missing: install xvfb";
  // Keep only the display's number: keyboard warnings precede it. Without -noreset the server
  // resets whenever its last window closes, and rejects clients meanwhile.
  Process display({"bash", "-c",
                   "exec Xvfb -displayfd 3 -noreset -screen 0 1400x1000x24 -nolisten tcp "
                   "3>&1 >/dev/null 2>&1"});
  std::string number;
  for (int i = 0; i < 200 && number.find('\n') == std::string::npos; ++i) {
    ASSERT_FALSE(display.wait(0.1) >= 0) << display.output();
    number = display.output();
  }
  number = number.substr(0, number.find('\n'));
  ASSERT_FALSE(number.empty()) << display.output();
  EXPECT_EQ(run_it({"--window", clip(10)}, {{"DISPLAY", ":" + number}}), 0) << output_;
  expect_contains(output_, "showing");
  expect_contains(output_, " frames");
  EXPECT_FALSE(std::filesystem::exists(file("out"))) << "files beside a window";
}

TEST_F(Run, NoWindowWhereNoDisplayAnswers) {
  EXPECT_EQ(run_it({"--window", clip(5)}, {{"DISPLAY", ":97"}}), 1);
  expect_contains(output_, "no window can be shown");
  EXPECT_EQ(run_it({file("in.mkv")}, {{"DISPLAY", ":97"}}), 0) << output_;
  EXPECT_TRUE(std::filesystem::exists(file("out/decomposition.mkv")));
}

}  // namespace
}  // namespace inverse::testing
