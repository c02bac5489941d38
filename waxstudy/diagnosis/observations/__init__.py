"""The record: channels made ready, their noise, which days serve for what, stand-ins for drives nobody recorded."""
