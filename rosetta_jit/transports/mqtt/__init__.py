"""MQTT, by `paho-mqtt`."""
