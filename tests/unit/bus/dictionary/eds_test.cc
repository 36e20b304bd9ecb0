#include "bus/dictionary/formats.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/dictionary/node_kinds.h"

namespace koboshi::bus {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Eds, DescribesAValueWithItsLimits) {
  EXPECT_THAT(eds_text(controller_kind()), HasSubstr("\n[2100sub3]\n"
                                                     "ParameterName=Ramp rate\n"
                                                     "ObjectType=0x7\n"
                                                     "DataType=0x0003\n"
                                                     "AccessType=rw\n"
                                                     "LowLimit=68\n"
                                                     "HighLimit=4096\n"
                                                     "DefaultValue=683\n"
                                                     "PDOMapping=0\n"));
}

TEST(Eds, RefersToTheNodeId) {
  const std::string eds = eds_text(drive_kind());
  EXPECT_THAT(eds,
              HasSubstr("\n[1800sub1]\nParameterName=COB-ID\nObjectType=0x7\nDataType=0x0007\nAccessType=rw\n"
                        "DefaultValue=$NODEID+0x40000180\n"));
  EXPECT_THAT(
      eds, HasSubstr("\n[1014]\nParameterName=COB-ID EMCY\nObjectType=0x7\nDataType=0x0007\nAccessType=rw\n"
                     "DefaultValue=$NODEID+0x80\n"));
}

TEST(Eds, SortsObjectsIntoTheirSections) {
  const std::string eds = eds_text(controller_kind());
  EXPECT_THAT(eds, HasSubstr("\n[MandatoryObjects]\nSupportedObjects=3\n1=0x1000\n2=0x1001\n3=0x1018\n"));
  EXPECT_LT(eds.find("[OptionalObjects]"), eds.find("[1003]"));
  EXPECT_LT(eds.find("[1A1Esub8]"), eds.find("[ManufacturerObjects]"));
  EXPECT_LT(eds.find("[ManufacturerObjects]"), eds.find("[2000]"));
}

TEST(Eds, StatesWhatAnRpdoMayWrite) {
  EXPECT_THAT(eds_text(drive_kind()), HasSubstr("\n[6040]\nParameterName=Controlword\nObjectType=0x7\n"
                                                "DataType=0x0006\nAccessType=rww\nPDOMapping=1\n"));
}

TEST(Eds, OmitsAMissingDefault) {
  for (const NodeKind& kind : documented_kinds({})) {
    EXPECT_THAT(eds_text(kind), Not(HasSubstr("DefaultValue=\n"))) << kind.name;
  }
}

}  // namespace
}  // namespace koboshi::bus
