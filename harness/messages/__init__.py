"""Samples as the bytes of ROS 2 messages, without ROS: published, recorded, sent to Foxglove.

rosbags knows the types; a message is CDR in little endian, which every middleware takes as it is.
"""
