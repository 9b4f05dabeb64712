#include <rsb/converter/Converter.h>
#include <rsb/converter/Repository.h>
#include <boost/make_shared.hpp>
#include <string>

/* A converter for RSB, between events' data of the class and messages. */
class converter : public rsb::converter::Converter<std::string> {
public:
    converter() : rsb::converter::Converter<std::string>($type, "." $wire, true) {}

    std::string serialize(const rsb::AnnotatedData &data, std::string &wire) override
    {
        codec own;
        wire = own.encode(*boost::static_pointer_cast<holder>(data.second));
        return getWireSchema();
    }

    rsb::AnnotatedData deserialize(const std::string &, const std::string &wire) override
    {
        codec own;
        const boost::shared_ptr<holder> message = boost::make_shared<holder>();
        own.decode(wire.data(), wire.size(), *message);
        return rsb::AnnotatedData(getDataType(), message);
    }
};

/* Makes RSB use the converter for all participants that are created later. */
inline void register_converter()
{
    rsb::converter::converterRepository<std::string>()->registerConverter(rsb::converter::Converter<std::string>::Ptr(new converter));
}
