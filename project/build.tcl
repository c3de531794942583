# Makes the bitstream: vivado -mode batch -source build.tcl, in this directory or from anywhere. Non-project flow; results in build/.
#
# Fails where a step fails, where Vivado finds an unsafe or unknown clock crossing in the constraints, and where the slack is negative.

set here [file dirname [file normalize [info script]]]
set out [file join $here build]
file mkdir $out
set part xc7k325tffg900-2

proc files {pattern} {
    global here
    return [lsort [glob -directory $here $pattern]]
}

# Vivado would go on without a memory image, with zeros in its place.
if {[file exists [file join $here manifest.json]]} {
    set manifest [open [file join $here manifest.json]]
    foreach {entry path} [regexp -all -inline {"path": "(mem/[^"]+)"} [read $manifest]] {
        if {![file exists [file join $here $path]]} {
            puts stderr "build.tcl: $path: this memory image is missing; generate the directory again"
            exit 1
        }
    }
    close $manifest
}

# Memory images are found from any working directory: their paths start here.
create_project -in_memory -part $part
set_property target_language Verilog [current_project]
set_property default_lib work [current_project]

# The DRAM controller, from its project file.
create_ip -name mig_7series -vendor xilinx.com -library ip -module_name mig_kc705 -dir $out
set_property -dict [list CONFIG.XML_INPUT_FILE [file join $here constraints mig.prj] \
    CONFIG.RESET_BOARD_INTERFACE Custom CONFIG.MIG_DONT_TOUCH_PARAM Custom CONFIG.BOARD_MIG_PARAM Custom] [get_ips mig_kc705]
generate_target all [get_ips mig_kc705]
synth_ip [get_ips mig_kc705]

read_verilog [files rtl/*.v]
read_mem [files mem/*.hex]
read_xdc [file join $here constraints kc705.xdc]
# After the files of the DRAM controller, whose clocks it limits.
read_xdc [file join $here constraints crossings.xdc]
set_property PROCESSING_ORDER LATE [get_files [file join $here constraints crossings.xdc]]

synth_design -top kc705_top -part $part -flatten_hierarchy rebuilt -verilog_define EDOF_DIR="$here/" -verilog_define SYNTHESIS
write_checkpoint -force [file join $out synthesised.dcp]
report_utilization -hierarchical -file [file join $out synthesised_utilization.rpt]

opt_design
place_design
phys_opt_design
route_design
phys_opt_design
write_checkpoint -force [file join $out routed.dcp]

report_utilization -file [file join $out utilization.rpt]
report_timing_summary -warn_on_violation -file [file join $out timing.rpt]
report_cdc -details -file [file join $out cdc.rpt]
report_clock_interaction -file [file join $out clocks.rpt]
report_drc -file [file join $out drc.rpt]
report_power -file [file join $out power.rpt]

foreach kind {setup hold} {
    set paths [get_timing_paths -max_paths 1 -$kind]
    if {[llength $paths] == 0} {
        puts stderr "build.tcl: no $kind path was timed: are the clocks constrained?"
        exit 1
    }
    set slack [get_property SLACK [lindex $paths 0]]
    puts "worst $kind slack: $slack ns"
    if {$slack < 0} {
        puts stderr "build.tcl: the worst $kind slack is $slack ns, below zero: see build/timing.rpt"
        exit 1
    }
}

write_bitstream -force [file join $out edof.bit]
puts "build/edof.bit is done: openFPGALoader -b kc705 build/edof.bit"
