"""Logs into other files: the messages of a topic as a table, those of many as a folder of tables, whole logs as other logs."""
