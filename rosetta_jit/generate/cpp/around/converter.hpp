#include <rsb/converter/Converter.h>
#include <rsb/converter/Repository.h>
#include <rsb/converter/SerializationException.h>
#include <rsc/runtime/TypeStringTools.h>
#include <boost/make_shared.hpp>
$clock#include <mutex>
#include <string>

/* A converter for RSB, between events' data of the class and messages. Several threads may use it. */
class converter : public rsb::converter::Converter<std::string> {
public:
    /* RSB finds a converter by the class of what is sent, and by the schema that received events name. */
    explicit converter(const std::string &schema = $wire)
        : rsb::converter::Converter<std::string>(rsc::runtime::typeName<holder>(), schema, true)
    {
    }

    /* Throws a SerializationException that says what is wrong, as deserialize does. */
    std::string serialize(const rsb::AnnotatedData &data, std::string &wire) override
    {
        const std::lock_guard<std::mutex> alone(mutex_);
$begins        const auto made = codec_.try_encode(*boost::static_pointer_cast<holder>(data.second), wire);
$ends        if (!made) {
            throw rsb::converter::SerializationException(made.error().what());
        }
        return getWireSchema();
    }

    rsb::AnnotatedData deserialize(const std::string &, const std::string &wire) override
    {
        const std::lock_guard<std::mutex> alone(mutex_);
        const boost::shared_ptr<holder> message = boost::make_shared<holder>();
$begins        const auto found = codec_.try_decode(wire.data(), wire.size(), *message);
$ends        if (!found) {
            throw rsb::converter::SerializationException(found.error().what());
        }
        return rsb::AnnotatedData(getDataType(), message);
    }

private:$nanoseconds
    codec codec_;
    std::mutex mutex_;
};

/* Makes RSB use the converter for all participants that are created later. */
inline void register_converter(const std::string &schema = $wire)
{
    rsb::converter::converterRepository<std::string>()->registerConverter(rsb::converter::Converter<std::string>::Ptr(new converter(schema)));
}
