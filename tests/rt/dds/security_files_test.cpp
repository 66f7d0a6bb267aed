// SPDX-License-Identifier: BSD-3-Clause
// Security files that do not belong together: the robot says which, and does not start.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "rt/base/errors.h"
#include "rt/dds/participant.h"
#include "tests/rt/dds/own_domain.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

class SecurityFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    if (run_shell("command -v openssl").code != 0) GTEST_SKIP() << "no openssl: no certificates";
    for (const char* name : {"ours", "theirs"}) {
      const Ended made = run_process({SANDRUNNER_SECURITY_SCRIPT, folder_.path(name)});
      ASSERT_EQ(made.code, 0) << made;
    }
  }

  /// Runs this in our folder, with theirs beside it.
  void change(const std::string& commands) {
    const Ended done = run_shell("cd " + folder_.path("ours") + " && " + commands);
    ASSERT_EQ(done.code, 0) << done;
  }
  /// A certificate for the robot's key, valid for `days` from now, by the authority in `folder`.
  void certify(const std::string& folder, int days) {
    change("openssl req -new -key robot.key -subj /CN=robot -out csr && openssl x509 -req -in csr" +
           (" -CA " + folder + "/ca.pem -CAkey " + folder + "/ca.key -CAcreateserial -days ") +
           std::to_string(days) + " -out robot.pem");
  }
  /// What the robot says; empty: it starts.
  std::string refusal() const {
    DdsNetwork network = own_network();
    network.security_dir = folder_.path("ours");
    try {
      const DdsParticipant robot(network);
      return "";
    } catch (const InputError& error) {
      return one_line(error.what());
    }
  }

  const TemporaryFolder folder_;
};

using testing::HasSubstr;

TEST_F(SecurityFilesTest, FilesThatBelongTogetherAreAccepted) { EXPECT_EQ(refusal(), ""); }

TEST_F(SecurityFilesTest, AKeyThatIsNotTheCertificatesIsRefused) {
  change("cp ../theirs/robot.key .");
  EXPECT_THAT(refusal(), HasSubstr("ours/robot.key: found a key that does not belong to " +
                                   folder_.path("ours/robot.pem")));
  change("cp operator.key robot.key");
  EXPECT_THAT(refusal(), HasSubstr("found a key that does not belong to"));
}

TEST_F(SecurityFilesTest, AFileThatIsNoKeyOrNoCertificateIsNamed) {
  change(
      "openssl ec -in robot.key -aes128 -passout pass:secret -out locked && mv locked robot.key");
  EXPECT_THAT(refusal(), HasSubstr("robot.key: expected a private key without a password"));
  change("echo nothing >robot.key");
  EXPECT_THAT(refusal(), HasSubstr("robot.key: expected a private key"));
  change("echo nothing >robot.pem");
  EXPECT_THAT(refusal(), HasSubstr("robot.pem: expected a certificate"));
}

TEST_F(SecurityFilesTest, ACertificateOfAnotherAuthorityIsRefused) {
  certify("../theirs", 10);
  EXPECT_THAT(refusal(), testing::AnyOf(HasSubstr("certificate signature failure"),
                                        // OpenSSL 3.5, of Debian 13.
                                        HasSubstr("unable to get local issuer certificate")));
}

TEST_F(SecurityFilesTest, ACertificateThatHasExpiredIsRefused) {
  certify(".", 0);
  EXPECT_THAT(refusal(), HasSubstr("certificate has expired"));
}

TEST_F(SecurityFilesTest, PermissionsThatAreChangedOrNotOursAreRefused) {
  change("cp ../theirs/robot.perm.p7s .");
  EXPECT_THAT(refusal(), HasSubstr("certificate verify error"));
  change("cp operator.perm.p7s robot.perm.p7s");
  EXPECT_THAT(refusal(), HasSubstr("Subject name is invalid"));
  change("sed -i s,rt/odom,rt/else, robot.perm.p7s");
  EXPECT_THAT(refusal(), HasSubstr("digest failure"));
}

TEST_F(SecurityFilesTest, PermissionsThatHaveExpiredAreRefused) {
  change(
      "openssl smime -verify -text -in robot.perm.p7s -CAfile ca.pem -out xml && "
      "sed -i 's,<not_before>[^<]*,<not_before>2001-01-01T00:00:00,; "
      "s,<not_after>[^<]*,<not_after>2002-01-01T00:00:00,' xml && "
      "openssl smime -sign -text -in xml -signer ca.pem -inkey ca.key -out robot.perm.p7s");
  EXPECT_THAT(refusal(), HasSubstr("validity period expired"));
}

TEST_F(SecurityFilesTest, RulesOfTheDomainThatAreNotOursAreRefused) {
  change("cp ../theirs/governance.p7s .");
  EXPECT_THAT(refusal(), HasSubstr("certificate verify error"));
}

}  // namespace
}  // namespace sandrunner
