// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiles compute shaders to SPIR-V by glslang's library and validates them, all in one process:
// the command glslangValidator takes .1 s to start.
//
// usage: compile_shaders ROOT OUTPUT_FOLDER VARIANT[,DEFINE…]… -- SHADER.comp…
//
// Writes OUTPUT_FOLDER/STEM.VARIANT.spv, and to the standard output each file that was read, once,
// one a line. `#include` finds files beside the one that includes, then from ROOT.
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <set>
#include <spirv-tools/libspirv.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Variant {
  std::string name;
  std::string preamble;  ///< a line for each define
};

Variant variant_of(const std::string& argument) {
  std::istringstream parts(argument);
  Variant variant;
  std::getline(parts, variant.name, ',');
  for (std::string define; std::getline(parts, define, ',');)
    variant.preamble += "#define " + define + "\n";
  return variant;
}

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw std::runtime_error("cannot read " + path.string());
  return text;
}

/// What glslang includes by.
class Files final : public glslang::TShader::Includer {
 public:
  explicit Files(fs::path root) : root_(std::move(root)) {}

  IncludeResult* includeLocal(const char* name, const char* includer, size_t /*depth*/) override {
    const fs::path beside = fs::path(includer).parent_path() / name;
    return included(fs::exists(beside) ? beside : root_ / name);
  }
  IncludeResult* includeSystem(const char* name, const char* /*includer*/,
                               size_t /*depth*/) override {
    return included(root_ / name);
  }
  void releaseInclude(IncludeResult* result) override {
    if (!result) return;
    delete static_cast<std::string*>(result->userData);
    delete result;
  }
  const std::set<std::string>& read_files() const { return read_; }

 private:
  IncludeResult* included(const fs::path& path) {
    if (!fs::exists(path)) return nullptr;
    const std::string name = path.lexically_normal().string();
    read_.insert(name);
    auto* text = new std::string(read(path));
    return new IncludeResult(name, text->data(), text->size(), text);
  }

  fs::path root_;
  std::set<std::string> read_;
};

std::vector<uint32_t> compile(const std::string& path, const std::string& text,
                              const Variant& variant, Files& files) {
  const auto refuse = [&](const std::string& log) {
    throw std::runtime_error(path + " (" + variant.name + "):\n" + log);
  };
  constexpr auto kRules = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);
  glslang::TShader shader(EShLangCompute);
  const char *code = text.c_str(), *name = path.c_str();
  shader.setStringsWithLengthsAndNames(&code, nullptr, &name, 1);
  shader.setPreamble(variant.preamble.c_str());
  shader.setEnvInput(glslang::EShSourceGlsl, EShLangCompute, glslang::EShClientVulkan, 100);
  shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_1);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_3);  // that of Vulkan 1.1
  if (!shader.parse(GetDefaultResources(), 100, false, kRules, files)) refuse(shader.getInfoLog());
  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(kRules)) refuse(program.getInfoLog());
  std::vector<uint32_t> words;
  glslang::GlslangToSpv(*program.getIntermediate(EShLangCompute), words);
  spvtools::SpirvTools tools(SPV_ENV_VULKAN_1_1);
  std::string wrong;
  tools.SetMessageConsumer([&](spv_message_level_t, const char*, const spv_position_t&,
                               const char* message) { wrong += std::string(message) + "\n"; });
  if (!tools.Validate(words)) refuse(wrong);
  return words;
}

}  // namespace

int main(int count, char** arguments) try {
  const fs::path root = arguments[1], output = arguments[2];
  std::vector<Variant> variants;
  int at = 3;
  for (; at < count && std::string(arguments[at]) != "--"; ++at)
    variants.push_back(variant_of(arguments[at]));
  std::set<std::string> read_files;
  glslang::InitializeProcess();
  for (++at; at < count; ++at) {
    const std::string path = arguments[at];
    read_files.insert(path);
    const std::string text = read(path);
    for (const Variant& variant : variants) {
      Files files(root);
      const std::vector<uint32_t> words = compile(path, text, variant, files);
      std::ofstream file(output / (fs::path(path).stem().string() + "." + variant.name + ".spv"),
                         std::ios::binary);
      file.write(reinterpret_cast<const char*>(words.data()),
                 static_cast<std::streamsize>(words.size() * sizeof(uint32_t)));
      if (!file.flush()) throw std::runtime_error("cannot write to " + output.string());
      read_files.insert(files.read_files().begin(), files.read_files().end());
    }
  }
  glslang::FinalizeProcess();
  for (const std::string& file : read_files) std::cout << file << "\n";
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
