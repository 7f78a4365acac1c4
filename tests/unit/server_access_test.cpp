// SPDX-License-Identifier: MIT
// Who may do what.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "access/tokens.hpp"
#include "core/error.hpp"
#include "util/ids.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

TEST(Tokens, AreReadAndCompared) {
  const auto file = std::filesystem::temp_directory_path() / ("sheaf-tokens-" + random_id());
  const auto tokens_of = [&](const std::string& text) {
    std::ofstream(file) << text;
    return Tokens(file.string());
  };
  const NewToken reader = make_token("reader=read"), both = make_token("both=read,submit");
  const Tokens tokens = tokens_of("# who\n" + reader.line + " # a comment\n\n" + both.line + "\n");
  const auto status = [&](const std::string& header, Scope scope) {
    Request request;
    if (!header.empty()) request.headers.emplace_back("Authorization", header);
    try {
      return tokens.authorize(request, scope);
    } catch (const Problem& problem) {
      return std::to_string(problem.status());
    }
  };
  EXPECT_EQ(status("Bearer " + reader.token, Scope::read), "reader");
  EXPECT_EQ(status("bearer  " + both.token, Scope::submit), "both");
  EXPECT_EQ(status("Bearer " + reader.token, Scope::submit), "403");
  for (const std::string& header : {std::string(), std::string("Bearer"), std::string("Bearer "), "Basic " + both.token,
                                    "Bearer " + both.token + "x", both.token, "Bearer " + std::string(600, 'a')})
    EXPECT_EQ(status(header, Scope::read), "401") << header;
  for (const std::string bad : {"", "# none\n", "a read sha256:00", "a write sha256:0", "a", "a! read x", "a read x y"})
    EXPECT_THROW(tokens_of(bad), Error) << bad;
  for (const std::string bad : {"", "a", "a=", "a=write", "=read", "a b=read"})
    EXPECT_THROW((void)make_token(bad), Error);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace sheaf::server
